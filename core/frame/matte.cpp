// A plane of coverage, the numbers of objects, or a Cryptomatte.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/matte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/cryptomatte.h"
#include "core/frame/input_files.h"
#include "core/frame/name_pattern.h"
#include "core/frame/plane_windows.h"

namespace alcove {
namespace {

/// The numbers of objects as the bits of the floats that a channel holds.
std::vector<std::uint32_t> numbers_of(const std::string& path, const std::string& channel, const std::string& objects) {
  std::vector<std::uint32_t> numbers;
  for (const auto& word : split(objects)) {
    float number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size())
      fail(ErrorKind::input,
           "{}: --matte-object {}: channel {} holds numbers, and is no layer of a Cryptomatte (--matte-channel)", path,
           word, channel);
    numbers.push_back(std::bit_cast<std::uint32_t>(number));
  }
  return numbers;
}

bool is_pattern(const std::string& word) { return word.find_first_of("*?") != word.npos; }

/// The objects of a Cryptomatte that a name or a pattern means.
std::vector<std::uint32_t> objects_of(const std::string& path, const Cryptomatte& matte, const std::string& word) {
  std::vector<std::uint32_t> objects;
  std::vector<std::string> names;
  for (const auto& [name, id] : matte.manifest) {
    names.push_back(name);
    if (fits_pattern(name, word)) objects.push_back(id);
  }
  if (!objects.empty()) return objects;
  if (matte.manifest.empty() && !is_pattern(word)) return {cryptomatte_id(word)};
  if (matte.manifest.empty())
    fail(ErrorKind::input,
         "{}: --matte-object {}: Cryptomatte {} has no manifest{}, so that only whole names are known", path, word,
         matte.name, matte.lacking.empty() ? "" : " (" + matte.lacking + ")");
  fail(ErrorKind::input, "{}: --matte-object {}: Cryptomatte {} has no such object{}; it has {}", path, word,
       matte.name, suggestion(word, names), list_of(names));
}

/// The Cryptomatte of that layer; without a layer the only one, or the only one that knows the objects.
const Cryptomatte& chosen(const std::vector<Cryptomatte>& mattes, const std::string& path, const std::string& layer,
                          const std::string& objects) {
  std::vector<std::string> names;
  std::vector<const Cryptomatte*> fitting;
  for (const auto& matte : mattes) {
    names.push_back(matte.name);
    const auto is_known = [&](const std::string& word) {
      return std::ranges::any_of(matte.manifest, [&](const auto& entry) { return fits_pattern(entry.first, word); });
    };
    const auto words = split(objects);
    if (layer.empty() ? std::ranges::any_of(words, is_known) : matte.name == layer) fitting.push_back(&matte);
  }
  if (fitting.size() == 1 || mattes.size() == 1) return fitting.empty() ? mattes.front() : *fitting.front();
  if (fitting.empty())
    fail(ErrorKind::input, "{}: --matte-object {}: none of the Cryptomattes {} has it", path, objects, list_of(names));
  fail(ErrorKind::input,
       "{}: --matte-object {}: several of the Cryptomattes {} have it: say which with --matte-channel", path, objects,
       list_of(names));
}

/// Takes the ranks and the objects of a Cryptomatte.
void take(FrameSource& source, std::size_t file, const Cryptomatte& matte, const std::string& objects) {
  const std::string& path = source.files[file].path();
  source.matte.kind = MatteKind::ranked;
  for (const auto& word : split(objects))
    std::ranges::copy(objects_of(path, matte, word), std::back_inserter(source.matte.objects));
  for (const auto& [object, coverage] : matte.ranks)
    for (const auto& channel : {object, coverage}) source[RawPlane::matte].push_back({file, matte.part, channel});
  if (source[RawPlane::matte].size() > kMostMattePlanes) source[RawPlane::matte].resize(kMostMattePlanes);
}

}  // namespace

void find_matte(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (!wants_matte(settings)) return;
  source.matte.outside = settings.matte_outside;
  const std::size_t file = search.open(settings.matte.empty() ? main_input(settings) : settings.matte, "--matte");
  const std::string& path = source.files[file].path();
  const std::string& objects = settings.matte_object;
  // A manifest may be long, and a file of coverage alone needs none.
  const bool may_be_ranked = !objects.empty() || !settings.matte_channel.empty();
  const auto mattes = may_be_ranked ? cryptomattes_of(source.files[file]) : std::vector<Cryptomatte>();
  const bool is_layer =
      std::ranges::any_of(mattes, [&](const Cryptomatte& matte) { return matte.name == settings.matte_channel; });
  if (is_layer && objects.empty())
    fail(ErrorKind::input, "{}: --matte-channel {} is a Cryptomatte: name its objects with --matte-object", path,
         settings.matte_channel);
  if (!objects.empty() && !is_layer && settings.matte_channel.empty() && mattes.empty())
    fail(ErrorKind::input,
         "{}: --matte-object {}: the file has no Cryptomatte; of a channel of numbers, name it with --matte-channel",
         path, objects);
  if (is_layer || (!objects.empty() && settings.matte_channel.empty())) {
    take(source, file, chosen(mattes, path, settings.matte_channel, objects), objects);
  } else {
    source[RawPlane::matte] =
        search.require(file, kMatteNames, settings.matte_channel, !settings.matte.empty(), "matte.Y");
    if (!objects.empty()) {
      source.matte.kind = MatteKind::objects;
      source.matte.objects = numbers_of(path, settings.matte_channel, objects);
    }
  }
  require_common_window(source, source[RawPlane::matte], "matte", "--matte", "where it has no pixels nothing is in it");
}

}  // namespace alcove
