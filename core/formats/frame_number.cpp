// Takes names apart at dots, underscores, hyphens and spaces.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/base/text.h"

namespace alcove {
namespace {

constexpr const char* kDigits = "0123456789";
constexpr const char* kSeparators = "._- ";
constexpr std::size_t kUsualDigits = 4;  // so many has a frame's number where nothing else tells
constexpr std::size_t kMostDigits = 9;   // more are a date, a time or a hash

/// A word between separators.
struct Part {
  std::string text;
  char before, after;  // the separators beside it; 0 at the ends of the name
  bool is_negative;    // a minus sign stands before it
};

bool is_digits(const std::string& text) { return !text.empty() && text.find_first_not_of(kDigits) == text.npos; }

/// "0005" of "shot0005"; "" of a word that ends otherwise.
std::string digits_at_end(const std::string& text) {
  const std::size_t last = text.find_last_not_of(kDigits);
  return last == text.npos ? text : text.substr(last + 1);
}

bool is_version(const std::string& text) {
  const std::string word = lower_case(text.substr(0, text.size() - digits_at_end(text).size()));
  return text.size() > word.size() && (word.ends_with("v") || word == "ver" || word == "version");
}

/// "1920x1080"
bool is_size(const std::string& text) {
  const std::size_t by = text.find_last_not_of(kDigits);
  return by != text.npos && by > 0 && lower_case(text.substr(by, 1)) == "x" && is_digits(text.substr(0, by));
}

std::vector<Part> parts_of(const std::string& name) {
  std::vector<Part> parts;
  const auto is_separator = [&](std::size_t at) {
    return std::string_view(kSeparators).find(name[at]) != std::string_view::npos;
  };
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of(kSeparators, begin), name.size());
    const char before = begin ? name[begin - 1] : char(0), after = end < name.size() ? name[end] : char(0);
    const bool is_negative = before == '-' && (begin == 1 || is_separator(begin - 2));
    if (end > begin) parts.push_back({name.substr(begin, end - begin), before, after, is_negative});
    begin = end + 1;
  }
  return parts;
}

/// Whether a number by itself is surely that of a frame. `before` are the parts before it.
bool is_clear(const Part& part, std::span<const Part> before) {
  const bool is_long = part.text.size() >= kUsualDigits;
  const bool is_subversion = !before.empty() && is_version(before.back().text) && part.text.size() < 3;
  const bool is_of_date = part.before == '-' && !before.empty() && is_digits(before.back().text) && !is_long;
  if (is_subversion || is_of_date) return false;
  return is_long || part.after == 0 || (part.before == '.' && part.after == '.');
}

FrameNumber number_of(const Part& part) {
  const int number = std::stoi(part.text);
  return {part.is_negative ? -number : number, part.text, ""};
}

/// Looks at a name in which no number stands by itself.
FrameNumber at_end_of_word(const Part& part) {
  const std::string digits = digits_at_end(part.text);
  if (digits.empty() || is_size(part.text) || digits.size() > kMostDigits) return {};
  if (is_version(part.text)) return {{}, digits, fmt::format("{} is a version", part.text)};
  if (digits.size() < kUsualDigits)
    return {{}, digits, fmt::format("{} may be the number of a shot or of a take", part.text)};
  return {std::stoi(digits), digits, ""};
}

}  // namespace

FrameNumber frame_number_in(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string ending = file.extension().string();
  const bool is_number = ending.size() > 1 && is_digits(ending.substr(1));  // shot.0005 has no other ending
  const std::vector<Part> parts = parts_of(is_number ? file.filename().string() : file.stem().string());
  for (std::size_t i = parts.size(); i-- > 0;) {
    const Part& part = parts[i];
    if (!is_digits(part.text) || part.text.size() > kMostDigits) continue;
    if (is_clear(part, std::span(parts).first(i))) return number_of(part);
    return {{}, part.text, fmt::format("{} may be something else", part.text)};
  }
  return parts.empty() ? FrameNumber{} : at_end_of_word(parts.back());
}

}  // namespace alcove
