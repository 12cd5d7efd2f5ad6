// Headers and manifests of Cryptomattes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/frame/views.h"

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

}  // namespace alcove
