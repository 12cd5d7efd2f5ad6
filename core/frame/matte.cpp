// A plane of coverage, the numbers of objects, or a Cryptomatte: of the receivers, and of the occluders.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/matte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/cryptomatte.h"
#include "core/frame/input_files.h"
#include "core/frame/name_pattern.h"
#include "core/frame/plane_windows.h"
#include "core/frame/typed_number.h"

namespace alcove {
namespace {

/// Which objects are meant, and the options that said so.
struct Objects {
  const std::string& words;  // names, patterns or numbers, with commas; empty: none, but coverage
  const char* option;
  const std::string& channel;
  const AovNames& channel_names;
};

/// The numbers of objects as the bits of the floats that a channel holds.
std::vector<std::uint32_t> numbers_of(const std::string& path, const Objects& meant) {
  std::vector<std::uint32_t> numbers;
  for (const auto& word : split(meant.words)) {
    const auto number = number_in(word);
    if (!number)
      fail(ErrorKind::input, "{}: {} {}: channel {} holds numbers, and is no layer of a Cryptomatte ({})", path,
           meant.option, word, meant.channel, meant.channel_names.channel_option);
    numbers.push_back(std::bit_cast<std::uint32_t>(*number));
  }
  return numbers;
}

bool is_pattern(const std::string& word) { return word.find_first_of("*?") != word.npos; }

/// The objects of a Cryptomatte that a name or a pattern means.
std::vector<std::uint32_t> objects_of(const std::string& path, const Cryptomatte& matte, const std::string& word,
                                      const char* option) {
  std::vector<std::uint32_t> objects;
  std::vector<std::string> names;
  for (const auto& [name, id] : matte.manifest) {
    names.push_back(name);
    if (fits_pattern(name, word)) objects.push_back(id);
  }
  if (!objects.empty()) return objects;
  if (matte.manifest.empty() && !is_pattern(word)) return {cryptomatte_id(word)};
  if (matte.manifest.empty())
    fail(ErrorKind::input, "{}: {} {}: Cryptomatte {} has no manifest{}, so that only whole names are known", path,
         option, word, matte.name, matte.lacking.empty() ? "" : " (" + matte.lacking + ")");
  fail(ErrorKind::input, "{}: {} {}: Cryptomatte {} has no such object{}; it has {}", path, option, word, matte.name,
       suggestion(word, names), list_of(names));
}

/// The Cryptomatte of that layer; without a layer the only one, or the only one that knows the objects.
const Cryptomatte& chosen(const std::vector<Cryptomatte>& mattes, const std::string& path, const Objects& meant) {
  std::vector<std::string> names;
  std::vector<const Cryptomatte*> fitting;
  for (const auto& matte : mattes) {
    names.push_back(matte.name);
    const auto is_known = [&](const std::string& word) {
      return std::ranges::any_of(matte.manifest, [&](const auto& entry) { return fits_pattern(entry.first, word); });
    };
    const auto words = split(meant.words);
    const bool fits = meant.channel.empty() ? std::ranges::any_of(words, is_known) : matte.name == meant.channel;
    if (fits) fitting.push_back(&matte);
  }
  if (fitting.size() == 1 || mattes.size() == 1) return fitting.empty() ? mattes.front() : *fitting.front();
  if (fitting.empty())
    fail(ErrorKind::input, "{}: {} {}: none of the Cryptomattes {} has it", path, meant.option, meant.words,
         list_of(names));
  fail(ErrorKind::input, "{}: {} {}: several of the Cryptomattes {} have it: say which with {}", path, meant.option,
       meant.words, list_of(names), meant.channel_names.channel_option);
}

/// Takes the ranks and the objects of a Cryptomatte.
void take(FrameSource& source, std::size_t file, const Cryptomatte& matte, const Objects& meant, MatteReading& reading,
          std::vector<ChannelRef>& channels) {
  const std::string& path = source.files[file].path();
  reading.kind = MatteKind::ranked;
  for (const auto& word : split(meant.words))
    std::ranges::copy(objects_of(path, matte, word, meant.option), std::back_inserter(reading.objects));
  for (const auto& [object, coverage] : matte.ranks)
    for (const auto& channel : {object, coverage}) channels.push_back({file, matte.part, channel});
  if (channels.size() <= kMostMattePlanes) return;
  channels.resize(kMostMattePlanes);
  add_new(source.notes,
          {{NoteCode::unread_ranks,
            fmt::format("Cryptomatte {} has {} ranks, of which the first {} are read: objects that cover little of a "
                        "pixel are left out ({})",
                        matte.name, matte.ranks.size(), kMostMattePlanes / 2, meant.option)}});
}

bool has_layer(const std::vector<Cryptomatte>& mattes, const std::string& layer) {
  return std::ranges::any_of(mattes, [&](const Cryptomatte& matte) { return matte.name == layer; });
}

/// Finds the objects that are occluders, or are none: by the Cryptomatte of the file, or by its channel of numbers,
/// where the settings name it or all objects are numbers.
void find_objects(FrameSource& source, ChannelSearch& search, std::size_t file, const Objects& meant, bool own_file) {
  const std::string& path = source.files[file].path();
  const auto mattes = cryptomattes_of(source.files[file]);
  const bool are_numbers =
      std::ranges::all_of(split(meant.words), [](const auto& word) { return number_in(word).has_value(); });
  const bool by_number = meant.channel.empty() ? are_numbers : !has_layer(mattes, meant.channel);
  auto& channels = source[RawPlane::occluders];
  if (by_number) {
    channels = search.require(file, meant.channel_names, meant.channel, own_file, "IndexOB.X");
    source.occluders.kind = MatteKind::objects;
    source.occluders.objects = numbers_of(path, meant);
    return;
  }
  if (mattes.empty())
    fail(ErrorKind::input,
         "{}: {} {}: the file has no Cryptomatte: give one with --objects, a file of coverage instead of names, or "
         "numbers of a channel (--object-channel)",
         path, meant.option, meant.words);
  take(source, file, chosen(mattes, path, meant), meant, source.occluders, channels);
}

}  // namespace

void find_matte(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (!wants_matte(settings)) return;
  source.matte.outside = settings.matte_outside;
  const std::size_t file = search.open(settings.matte.empty() ? main_input(settings) : settings.matte, "--matte");
  const std::string& path = source.files[file].path();
  const std::string& objects = settings.matte_object;
  const Objects meant{objects, "--matte-object", settings.matte_channel, kMatteNames};
  // A manifest may be long, and a file of coverage alone needs none.
  const bool may_be_ranked = !objects.empty() || !settings.matte_channel.empty();
  const auto mattes = may_be_ranked ? cryptomattes_of(source.files[file]) : std::vector<Cryptomatte>();
  const bool is_layer = has_layer(mattes, settings.matte_channel);
  if (is_layer && objects.empty())
    fail(ErrorKind::input, "{}: --matte-channel {} is a Cryptomatte: name its objects with --matte-object", path,
         settings.matte_channel);
  if (!objects.empty() && !is_layer && settings.matte_channel.empty() && mattes.empty())
    fail(ErrorKind::input,
         "{}: --matte-object {}: the file has no Cryptomatte; of a channel of numbers, name it with --matte-channel",
         path, objects);
  if (is_layer || (!objects.empty() && settings.matte_channel.empty())) {
    take(source, file, chosen(mattes, path, meant), meant, source.matte, source[RawPlane::matte]);
  } else {
    source[RawPlane::matte] =
        search.require(file, kMatteNames, settings.matte_channel, !settings.matte.empty(), "matte.Y");
    if (!objects.empty()) {
      source.matte.kind = MatteKind::objects;
      source.matte.objects = numbers_of(path, meant);
    }
  }
  require_common_window(source, source[RawPlane::matte], "matte", "--matte", "where it has no pixels nothing is in it");
}

void find_occluders(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (!chooses_occluders(settings)) return;
  source.occluders.ignores = !settings.ignore.empty() || !settings.ignored_objects.empty();
  const char* option = source.occluders.ignores ? "--ignore" : "--occluders";
  const std::string& coverage = source.occluders.ignores ? settings.ignore : settings.occluders;
  if (!coverage.empty()) {
    const std::size_t file = search.open(coverage, option);
    source[RawPlane::occluders] = search.require(file, kMatteNames, "", true, "matte.Y");
  } else {
    const std::string& words = source.occluders.ignores ? settings.ignored_objects : settings.occluder_objects;
    const bool own_file = !settings.objects.empty();
    const std::size_t file = search.open(own_file ? settings.objects : main_input(settings), "--objects");
    find_objects(source, search, file, {words, option, settings.object_channel, kObjectNames}, own_file);
  }
  require_common_window(
      source, source[RawPlane::occluders], "choice of occluders", option,
      source.occluders.ignores ? "nothing is ignored where it has no pixels" : "nothing blocks where it has no pixels");
}

}  // namespace alcove
