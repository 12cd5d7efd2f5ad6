// Characters of UTF-8, lists, and distances between names.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <locale>
#include <numeric>
#include <sstream>

namespace alcove {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

namespace {

/// The first character of a text in UTF-8.
struct Character {
  char32_t code;
  std::size_t bytes;  // 0: the first byte belongs to no character
};

/// The number of bytes of a character with this first byte; 0 if no character begins with it.
std::size_t bytes_after(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead < 0xc2) return 0;
  if (lead < 0xe0) return 2;
  if (lead < 0xf0) return 3;
  return lead < 0xf5 ? 4 : 0;
}

/// Decodes one character. Overlong spellings and halves of surrogate pairs are not characters.
Character first_character(std::string_view text) {
  constexpr Character kNone{0, 0};
  constexpr std::array<char32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};  // codes that need so many bytes
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t bytes = bytes_after(lead);
  if (bytes == 0 || bytes > text.size()) return kNone;
  if (bytes == 1) return {lead, 1};
  char32_t code = lead & (0x7fu >> bytes);
  for (const char next : text.substr(1, bytes - 1)) {
    if ((next & 0xc0) != 0x80) return kNone;
    code = code << 6 | (next & 0x3f);
  }
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  return code < kLeast[bytes] || code > 0x10ffff || is_surrogate ? kNone : Character{code, bytes};
}

/// Whether a character is a control character, which terminals may obey.
bool is_control(char32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// Whether a character turns the direction of writing, so that a name looks like another.
bool turns_writing(char32_t code) {
  return code == 0x61c || code == 0x200e || code == 0x200f || (code >= 0x202a && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

/// The text in UTF-8, with ? in place of the characters that `hides` picks.
template <class Hides>
std::string escaped(std::string_view text, Hides hides) {
  std::string shown;
  while (!text.empty()) {
    const auto [code, bytes] = first_character(text);
    if (bytes == 0)
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    else if (hides(code))
      shown += '?';
    else
      shown += text.substr(0, bytes);
    text.remove_prefix(std::max<std::size_t>(1, bytes));
  }
  return shown;
}

}  // namespace

std::string as_utf8(std::string_view text) {
  return escaped(text, [](char32_t) { return false; });
}

std::string markup_text(std::string_view text) {
  std::string markup;
  for (const char c : text) {
    switch (c) {
      case '&': markup += "&amp;"; break;
      case '<': markup += "&lt;"; break;
      case '>': markup += "&gt;"; break;
      case '"': markup += "&quot;"; break;
      default: markup += c;
    }
  }
  return markup;
}

std::string printable(std::string_view text) {
  return escaped(text, [](char32_t code) { return is_control(code) || turns_writing(code); });
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
  const std::string more = names.size() > most ? fmt::format(" and {} more", names.size() - most) : "";
  return fmt::format("{}{}", fmt::join(names.first(std::min(names.size(), most)), ", "), more);
}

std::string counted(std::size_t count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::string linked(std::span<const std::string> words, const char* link) {
  if (words.size() < 2) return words.empty() ? "" : words.front();
  const auto all_but_last = words.first(words.size() - 1);
  return fmt::format("{} {} {}", fmt::join(all_but_last, ", "), link, words.back());
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

/// The end of a dotted name, with as many parts as `like` has: "Deph.Z" of "ViewLayer.Deph.Z" for "Depth.Z".
std::string_view tail_like(std::string_view name, std::string_view like) {
  auto dots = std::ranges::count(like, '.');
  for (std::size_t at = name.size(); at-- > 0;)
    if (name[at] == '.' && dots-- == 0) return name.substr(at + 1);
  return name;
}

/// An edit distance. A name in another layer, or one that contains the other, is near however long the rest is.
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

std::optional<double> number_of(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error != std::errc::result_out_of_range) return value;
  // std::from_chars leaves the value alone, whether the number is too large or too near to 0. A stream gives the
  // largest number, or 0.
  std::istringstream stream{std::string(text)};
  stream.imbue(std::locale::classic());
  stream >> value;
  return std::abs(value) < 1 ? value : std::copysign(std::numeric_limits<double>::infinity(), value);
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates) {
  const auto names = nearest_names(name, candidates);
  return names.empty() ? std::string() : fmt::format(" (did you mean {}?)", fmt::join(names, " or "));
}

std::string for_shell(const std::string& word) {
  constexpr bool kIsWindows = std::filesystem::path::preferred_separator == '\\';
  constexpr std::string_view kPlain = "\\abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./%-+=:,";
  const std::string_view plain = kPlain.substr(kIsWindows ? 0 : 1, kPlain.size() - 1);  // PowerShell cuts at commas
  if (word.find_first_not_of(plain) == word.npos && !word.empty()) return word;
  if (kIsWindows) return '"' + word + '"';  // no name of a file has a quote there
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string typed(std::string_view option, std::string_view value) {
  return fmt::format("{}{}{}", option, option.starts_with("--set ") ? '=' : ' ', value);
}

namespace {

using Json = nlohmann::ordered_json;

Json with_valid_strings(const Json& json) {
  if (json.is_string()) return as_utf8(json.get_ref<const std::string&>());
  if (!json.is_structured()) return json;
  Json valid = json.is_array() ? Json::array() : Json::object();
  for (const auto& [key, value] : json.items()) {
    if (json.is_array())
      valid.push_back(with_valid_strings(value));
    else
      valid[as_utf8(key)] = with_valid_strings(value);
  }
  return valid;
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& json, int indent) { return with_valid_strings(json).dump(indent); }

nlohmann::json json_of(const std::string& text, int deepest, std::string& why) {
  // The parser would tell the depth, but looks then at all entries of a list for each of them.
  int depth = 0, most = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); i++) {
    if (is_quoted && text[i] == '\\')
      i++;
    else if (text[i] == '"')
      is_quoted = !is_quoted;
    else if (!is_quoted && (text[i] == '{' || text[i] == '['))
      most = std::max(most, ++depth);
    else if (!is_quoted && (text[i] == '}' || text[i] == ']'))
      depth--;
  }
  why = fmt::format("; its JSON nests deeper than {}", deepest);
  if (most > deepest) return nullptr;
  why.clear();
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + std::ptrdiff_t(std::min(error.byte, text.size()));
    why = fmt::format("; line {} is no JSON", 1 + std::count(text.begin(), end, '\n'));
  } catch (const nlohmann::json::exception&) {
    why = "; it has a number that no computer holds";
  }
  return nullptr;
}

std::string frames_text(std::vector<int> frames) {
  std::ranges::sort(frames);
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i + 1;
    while (end < frames.size() && frames[end] == frames[end - 1] + 1) end++;
    if (!text.empty()) text += ", ";
    text += end - i == 1 ? fmt::format("{}", frames[i]) : fmt::format("{}-{}", frames[i], frames[end - 1]);
    i = end;
  }
  return text;
}

std::string short_frames_text(const std::vector<int>& frames) {
  constexpr std::ptrdiff_t kMostParts = 10;
  std::string text = frames_text(frames);
  if (frames.empty() || std::ranges::count(text, ',') < kMostParts) return text;
  const auto [first, last] = std::ranges::minmax(frames);
  return fmt::format("{} frames from {} to {}", frames.size(), first, last);
}

}  // namespace alcove
