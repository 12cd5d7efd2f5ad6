// Headers and manifests of Cryptomattes; planes of coverage, of objects' numbers, and of Cryptomattes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/matte.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/frame/find/channels.h"
#include "core/frame/raw_plane.h"

namespace alcove {
namespace {

constexpr const char* kPrefix = "cryptomatte/";

std::uint32_t mixed(std::uint32_t word) { return std::rotl(word * 0xcc9e2d51U, 15) * 0x1b873593U; }

/// Names and identifiers of {"name": "7f00a1b2", ...}.
std::map<std::string, std::uint32_t> manifest_of(const std::string& text) {
  std::map<std::string, std::uint32_t> manifest;
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return manifest;
  for (const auto& [name, value] : json.items()) {
    if (!value.is_string()) continue;
    const auto digits = value.get<std::string>();
    std::uint32_t id = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), id, 16);
    if (error == std::errc() && end == digits.data() + digits.size()) manifest.emplace(name, id);
  }
  return manifest;
}

/// The manifest of the header, `key` and its name together, or of the file beside it that the header names.
void read_manifest(const ExrFile& file, const std::map<std::string, std::string>& header, const std::string& key,
                   Cryptomatte& matte) {
  namespace fs = std::filesystem;
  const auto value = [&](const char* name) {
    const auto found = header.find(key + name);
    return found == header.end() ? "" : found->second;
  };
  const std::string beside = value("manif_file");
  matte.manifest = manifest_of(value("manifest"));
  if (!matte.manifest.empty() || beside.empty()) return;
  // It must lie beside the file: what a header says opens nothing elsewhere.
  matte.manifest_file = (fs::path(file.path()).parent_path() / fs::path(beside).filename()).string();
  try {
    matte.manifest = manifest_of(read_text(matte.manifest_file, "Cryptomatte manifest", "--matte"));
    if (matte.manifest.empty()) matte.lacking = matte.manifest_file + " is no manifest";
  } catch (const Error& error) {
    matte.lacking = error.what();
  }
}

/// The rank and the component (0: first object, 1: its coverage, 2, 3) of a channel such as CryptoObject01.B; nothing
/// where it is none of the layer's.
std::optional<std::pair<int, int>> place_of(const std::string& channel, const std::string& layer) {
  const std::size_t digits = layer.size();
  if (!channel.starts_with(layer) || channel.size() < digits + 4 || channel[digits + 2] != '.') return std::nullopt;
  if (!std::isdigit((unsigned char)channel[digits]) || !std::isdigit((unsigned char)channel[digits + 1]))
    return std::nullopt;
  const int pair = 10 * (channel[digits] - '0') + channel[digits + 1] - '0';
  const std::string last = lower_case(channel.substr(digits + 3));
  const std::vector<std::vector<std::string>> names{{"r", "red"}, {"g", "green"}, {"b", "blue"}, {"a", "alpha"}};
  for (int i = 0; i < 4; i++)
    if (std::ranges::find(names[std::size_t(i)], last) != names[std::size_t(i)].end()) return std::pair(pair, i);
  return std::nullopt;
}

std::vector<Cryptomatte::Rank> ranks_of(const ExrPart& part, const std::string& layer, const std::string& view) {
  std::map<std::pair<int, int>, std::string> places;
  for (const auto& channel : part.channels)
    if (const auto name = name_in_view(part, channel.name, view))
      if (const auto place = place_of(*name, layer)) places.emplace(*place, channel.name);
  std::vector<Cryptomatte::Rank> ranks;
  for (const auto& [place, object] : places) {
    const auto coverage = places.find({place.first, place.second + 1});
    if (place.second % 2 == 0 && coverage != places.end()) ranks.push_back({object, coverage->second});
  }
  return ranks;
}

}  // namespace

std::uint32_t cryptomatte_id(const std::string& name) {
  std::uint32_t hash = 0, tail = 0;
  const std::size_t whole = name.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 4; b++) word |= std::uint32_t((unsigned char)name[i + b]) << (8 * b);
    hash = std::rotl(hash ^ mixed(word), 13) * 5 + 0xe6546b64U;
  }
  for (std::size_t i = name.size(); i > whole; i--) tail = tail << 8 | std::uint32_t((unsigned char)name[i - 1]);
  hash ^= mixed(tail) ^ std::uint32_t(name.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bU;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35U;
  hash ^= hash >> 16;
  // Zero, what is too small for a normal number, infinity and NaN would not outlive what programs do to floats.
  const std::uint32_t exponent = hash >> 23 & 255U;
  return exponent == 0 || exponent == 255 ? hash ^ 1U << 23 : hash;
}

std::vector<Cryptomatte> cryptomattes_of(const ExrFile& file, const std::string& view) {
  const std::string in_file = view_in(file, view);
  std::vector<Cryptomatte> found;
  for (std::size_t i = 0; i < file.parts().size(); i++) {
    const auto header = file.whole_texts(int(i), kPrefix);
    for (const auto& [key, text] : header) {
      if (!key.ends_with("/name")) continue;
      Cryptomatte matte{text, int(i)};
      matte.ranks = ranks_of(file.parts()[i], matte.name, in_file);
      if (matte.ranks.empty()) continue;
      read_manifest(file, header, key.substr(0, key.size() - std::string("name").size()), matte);
      found.push_back(std::move(matte));
    }
  }
  return found;
}

// Receivers and occluders.

namespace {

/// The objects that a user selects, and the options that say so.
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
      fail(ErrorKind::input, "{}: {}: channel {} holds numbers, and is no layer of a Cryptomatte ({})", path,
           typed(meant.option, word), meant.channel, meant.channel_names.channel_option);
    numbers.push_back(std::bit_cast<std::uint32_t>(*number));
  }
  return numbers;
}

constexpr std::size_t kShownObjects = 8;
constexpr const char* kEscapes = "a backslash before a comma, a blank, * or ? takes it as a part of the name";

/// Objects' names as a message shows them: blanks at their ends are seen, and commas are told from those between them.
std::vector<std::string> shown(const std::vector<std::string>& names) {
  std::vector<std::string> quoted;
  for (const auto& name : names) {
    const bool is_clear = name.find(',') == name.npos && !name.starts_with(' ') && !name.ends_with(' ');
    quoted.push_back(is_clear ? name : "'" + name + "'");
  }
  return quoted;
}

/// Cuts a list at the next comma that belongs to no name.
std::vector<std::string> parts_of(const std::string& words) {
  std::vector<std::string> parts(1);
  for (std::size_t i = 0; i < words.size(); i++) {
    if (words[i] == ',') {
      parts.emplace_back();
      continue;
    }
    if (is_escape(words, i)) parts.back() += words[i++];
    parts.back() += words[i];
  }
  return parts;
}

/// Takes blanks from both ends, but those behind a backslash.
std::string trimmed(const std::string& text) {
  const std::size_t first = std::min(text.find_first_not_of(' '), text.size());
  std::size_t end = text.size();
  while (end > first && text[end - 1] == ' ' && !(end >= first + 2 && is_escape(text, end - 2))) end--;
  return text.substr(first, end - first);
}

/// The meaning of a user's list in one Cryptomatte.
struct ListMeaning {
  /// A word of the list, and the names that it stands for: none, itself, or those that fit it as a pattern.
  struct Word {
    std::string text;
    std::vector<std::string> names;
    bool is_exact;
  };
  std::vector<Word> words;

  bool has_exact() const { return std::ranges::any_of(words, &Word::is_exact); }
  bool has_any() const {
    return std::ranges::any_of(words, [](const Word& word) { return !word.names.empty(); });
  }
};

/// The object whose name is that text as it stands, or without its outer blanks, or without its backslashes.
std::optional<std::string> exact_name(const Cryptomatte& matte, const std::string& text) {
  for (const auto& name : {text, trimmed(text), unescaped(trimmed(text))})
    if (matte.manifest.contains(name)) return name;
  return std::nullopt;
}

/// Finds the longest runs of the list that are a name, since names may have commas; all else is words between commas,
/// which may be patterns. So a name that is given exactly is that object.
ListMeaning meaning_of(const Cryptomatte& matte, const std::string& list) {
  ListMeaning meaning;
  const auto parts = parts_of(list);
  for (std::size_t i = 0; i < parts.size();) {
    const auto name_to = [&](std::size_t end) {
      return exact_name(matte, fmt::format("{}", fmt::join(std::span(parts).subspan(i, end - i), ",")));
    };
    std::size_t end = parts.size();
    auto name = name_to(end);
    while (!name && --end > i) name = name_to(end);
    if (name) {
      meaning.words.push_back({*name, {*name}, true});
      i = end;
      continue;
    }
    ListMeaning::Word word{trimmed(parts[i++]), {}, false};
    for (const auto& [known, id] : matte.manifest)
      if (fits_pattern(known, word.text)) word.names.push_back(known);
    meaning.words.push_back(std::move(word));
  }
  return meaning;
}

/// The objects that a word means, each name's identifier. Without a manifest a whole name is known by its hash.
std::vector<std::uint32_t> objects_of(const std::string& path, const Cryptomatte& matte, const ListMeaning::Word& word,
                                      const char* option) {
  std::vector<std::uint32_t> objects;
  for (const auto& name : word.names) objects.push_back(matte.manifest.at(name));
  if (!objects.empty()) return objects;
  if (matte.manifest.empty() && !is_pattern(word.text)) return {cryptomatte_id(unescaped(word.text))};
  if (matte.manifest.empty())
    fail(ErrorKind::input, "{}: {}: Cryptomatte {} has no manifest{}, so only whole names are known; {}", path,
         typed(option, word.text), matte.name, matte.lacking.empty() ? "" : " (" + matte.lacking + ")", kEscapes);
  std::vector<std::string> names;
  for (const auto& [name, id] : matte.manifest) names.push_back(name);
  const auto near = shown(nearest_names(word.text, names));
  fail(ErrorKind::input, "{}: {}: Cryptomatte {} has no such object{}; it has {}; {}", path, typed(option, word.text),
       matte.name, near.empty() ? "" : fmt::format(" (did you mean {}?)", linked(near, "or")), list_of(shown(names)),
       kEscapes);
}

/// The Cryptomatte of that layer; without a layer the only one, or the only one that knows the objects: by their names,
/// or else by patterns.
const Cryptomatte& chosen(const std::vector<Cryptomatte>& mattes, const std::string& path, const Objects& meant) {
  std::vector<std::string> names;
  std::vector<const Cryptomatte*> exact, fitting;
  for (const auto& matte : mattes) {
    names.push_back(matte.name);
    const ListMeaning meaning = meaning_of(matte, meant.words);
    if (meant.channel.empty() ? meaning.has_any() : matte.name == meant.channel) fitting.push_back(&matte);
    if (meant.channel.empty() && meaning.has_exact()) exact.push_back(&matte);
  }
  if (!exact.empty()) fitting = exact;
  if (fitting.size() == 1 || mattes.size() == 1) return fitting.empty() ? mattes.front() : *fitting.front();
  if (fitting.empty())
    fail(ErrorKind::input, "{}: {}: none of the Cryptomattes {} has it; {}", path, typed(meant.option, meant.words),
         list_of(names), kEscapes);
  fail(ErrorKind::input, "{}: {}: several of the Cryptomattes {} have it: say which with {}", path,
       typed(meant.option, meant.words), list_of(names), meant.channel_names.channel_option);
}

/// Takes the ranks and the objects of a Cryptomatte.
void take(FrameSource& source, std::size_t file, const Cryptomatte& matte, const Objects& meant, MatteReading& reading,
          std::vector<ChannelRef>& channels) {
  const std::string& path = source.files[file].path();
  reading.kind = MatteKind::ranked;
  for (const auto& word : meaning_of(matte, meant.words).words) {
    std::ranges::copy(objects_of(path, matte, word, meant.option), std::back_inserter(reading.objects));
    if (word.names.size() > 1)
      source.notes.push_back({NoteCode::several_objects,
                              fmt::format("{} stands for {} objects of {}: {}", typed(meant.option, word.text),
                                          word.names.size(), matte.name, list_of(shown(word.names), kShownObjects))});
  }
  for (const auto& [object, coverage] : matte.ranks)
    for (const auto& channel : {object, coverage}) channels.push_back({file, matte.part, channel});
  if (channels.size() <= kMostMattePlanes) return;
  channels.resize(kMostMattePlanes);
  add_new(source.notes,
          {{NoteCode::unread_ranks, fmt::format("Cryptomatte {} has {} ranks, and only the first {} are read: objects "
                                                "that cover little of a pixel are left out ({})",
                                                matte.name, matte.ranks.size(), kMostMattePlanes / 2, meant.option)}});
}

bool has_layer(const std::vector<Cryptomatte>& mattes, const std::string& layer) {
  return std::ranges::any_of(mattes, [&](const Cryptomatte& matte) { return matte.name == layer; });
}

/// Finds the objects that are occluders, or are none: by the Cryptomatte of the file, or by its channel of numbers,
/// where the settings name it or all objects are numbers.
void find_objects(FrameSource& source, ChannelSearch& search, std::size_t file, const Objects& meant, bool own_file) {
  const std::string& path = source.files[file].path();
  const auto mattes = cryptomattes_of(source.files[file], source.channels.view);
  const bool are_numbers =
      std::ranges::all_of(split(meant.words), [](const auto& word) { return number_in(word).has_value(); });
  const auto are_names = [&] {
    return std::ranges::any_of(mattes, [&](const auto& matte) { return meaning_of(matte, meant.words).has_exact(); }) &&
           search.find(file, meant.channel_names, "", own_file).empty();
  };
  const bool by_number = meant.channel.empty() ? are_numbers && !are_names() : !has_layer(mattes, meant.channel);
  auto& channels = source.channels[RawPlane::occluders];
  if (by_number) {
    channels = search.require(file, meant.channel_names, meant.channel, own_file, "IndexOB.X");
    source.reading.occluders.kind = MatteKind::objects;
    source.reading.occluders.objects = numbers_of(path, meant);
    return;
  }
  if (mattes.empty())
    fail(ErrorKind::input,
         "{}: {}: the file has no Cryptomatte: give one with --set objects, a file of coverage instead of names, or "
         "numbers of a channel (--set object-channel)",
         path, typed(meant.option, meant.words));
  take(source, file, chosen(mattes, path, meant), meant, source.reading.occluders, channels);
}

}  // namespace

void find_matte(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (!wants_matte(settings)) return;
  source.reading.matte.outside = settings.matte_outside;
  const std::size_t file = search.open(settings.matte.empty() ? main_input(settings) : settings.matte, "--matte");
  const std::string& path = source.files[file].path();
  const std::string& objects = settings.matte_object;
  const Objects meant{objects, "--matte-object", settings.matte_channel, kMatteNames};
  // A manifest may be long, and a file of coverage alone needs none.
  const bool may_be_ranked = !objects.empty() || !settings.matte_channel.empty();
  const auto mattes =
      may_be_ranked ? cryptomattes_of(source.files[file], source.channels.view) : std::vector<Cryptomatte>();
  const bool is_layer = has_layer(mattes, settings.matte_channel);
  if (is_layer && objects.empty())
    fail(ErrorKind::input, "{}: --set matte-channel={} is a Cryptomatte: name its objects with --matte-object", path,
         settings.matte_channel);
  if (!objects.empty() && !is_layer && settings.matte_channel.empty() && mattes.empty())
    fail(
        ErrorKind::input,
        "{}: --matte-object {}: the file has no Cryptomatte; of a channel of numbers, name it with --set matte-channel",
        path, objects);
  if (is_layer || (!objects.empty() && settings.matte_channel.empty())) {
    take(source, file, chosen(mattes, path, meant), meant, source.reading.matte, source.channels[RawPlane::matte]);
  } else {
    source.channels[RawPlane::matte] =
        search.require(file, kMatteNames, settings.matte_channel, !settings.matte.empty(), "matte.Y");
    if (!objects.empty()) {
      source.reading.matte.kind = MatteKind::objects;
      source.reading.matte.objects = numbers_of(path, meant);
    }
  }
  require_common_window(source, source.channels[RawPlane::matte], "matte", "--matte",
                        "where it has no pixels nothing is in it");
}

void find_occluders(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (!chooses_occluders(settings)) return;
  source.reading.occluders.ignores = !settings.ignore.empty() || !settings.ignored_objects.empty();
  const char* option = source.reading.occluders.ignores ? "--set ignore" : "--set occluders";
  const std::string& coverage = source.reading.occluders.ignores ? settings.ignore : settings.occluders;
  if (!coverage.empty()) {
    const std::size_t file = search.open(coverage, option);
    source.channels[RawPlane::occluders] = search.require(file, kMatteNames, "", true, "matte.Y");
  } else {
    const std::string& words = source.reading.occluders.ignores ? settings.ignored_objects : settings.occluder_objects;
    const bool own_file = !settings.objects.empty();
    const std::size_t file = search.open(own_file ? settings.objects : main_input(settings), "--set objects");
    find_objects(source, search, file, {words, option, settings.object_channel, kObjectNames}, own_file);
  }
  require_common_window(source, source.channels[RawPlane::occluders], "choice of occluders", option,
                        source.reading.occluders.ignores ? "nothing is ignored where it has no pixels"
                                                         : "nothing blocks where it has no pixels");
}

}  // namespace alcove
