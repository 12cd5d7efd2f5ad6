// Case, lists and the nearest of a set of names.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>

namespace alcove {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  // In UTF-8: the controls U+0080 to U+009F, of which terminals obey some, and what turns the direction of writing:
  // U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069.
  std::string shown;
  for (std::size_t i = 0; i < text.size(); i++) {
    const auto byte = [&](std::size_t at) {
      return i + at < text.size() ? static_cast<unsigned char>(text[i + at]) : 0u;
    };
    const unsigned two = byte(0) << 8 | byte(1), three = two << 8 | byte(2);
    const bool is_control = (two >= 0xc280 && two <= 0xc29f) || two == 0xd89c;
    const bool turns = three == 0xe2808e || three == 0xe2808f || (three >= 0xe280aa && three <= 0xe280ae) ||
                       (three >= 0xe281a6 && three <= 0xe281a9);
    shown += is_control || turns ? '?' : text[i];
    i += turns ? 2 : is_control ? 1 : 0;
  }
  return shown;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string part = text.substr(start, end - start);
    const std::size_t first = part.find_first_not_of(' '), last = part.find_last_not_of(' ');
    parts.push_back(first == part.npos ? "" : part.substr(first, last - first + 1));
    start = end + 1;
  }
  return parts;
}

std::string list_of(std::span<const std::string> names, std::size_t most) {
  if (names.empty()) return "nothing";
  std::string text = names[0];
  for (std::size_t i = 1; i < std::min(names.size(), most); i++) text += ", " + names[i];
  if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
  return text;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::string from = lower_case(a), to = lower_case(b);
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < from.size(); i++) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < to.size(); j++) {
      const std::size_t replaced = diagonal + (from[i] != to[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

namespace {

/// The end of a dotted name with as many parts as `like` has: "Deph.Z" of "ViewLayer.Deph.Z" for "Depth.Z".
std::string_view tail_like(std::string_view name, std::string_view like) {
  auto dots = std::ranges::count(like, '.');
  for (std::size_t at = name.size(); at-- > 0;)
    if (name[at] == '.' && dots-- == 0) return name.substr(at + 1);
  return name;
}

/// An edit distance in which a name below another layer, or one that is part of the other, is near however long the
/// rest is.
std::size_t distance_of(std::string_view name, std::string_view candidate) {
  const std::string a = lower_case(name), b = lower_case(candidate);
  if (a == b) return 0;
  const bool contained = a.size() > 1 && b.size() > 1 && (a.find(b) != a.npos || b.find(a) != b.npos);
  const std::size_t below = edit_distance(name, tail_like(candidate, name)) + 1;
  return contained ? 1 : std::min(edit_distance(name, candidate), below);
}

}  // namespace

std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> candidates,
                                       std::size_t most) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const auto& candidate : candidates) {
    const std::size_t distance = distance_of(name, candidate);
    if (distance <= std::max<std::size_t>(2, name.size() / 3)) ranked.emplace_back(distance, candidate);
  }
  std::ranges::stable_sort(ranked, {}, &std::pair<std::size_t, std::string>::first);
  std::vector<std::string> names;
  for (const auto& [distance, candidate] : ranked)
    if (names.size() < most) names.push_back(candidate);
  return names;
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates) {
  const auto names = nearest_names(name, candidates);
  return names.empty() ? std::string() : fmt::format(" (did you mean {}?)", fmt::join(names, " or "));
}

}  // namespace alcove
