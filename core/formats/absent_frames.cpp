// Tokens and ranges of other programs, and names of files that differ from a pattern in little.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/absent_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <regex>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

std::string text_of(const FramePattern& pattern) {
  return pattern.before + frame_token(std::size_t(pattern.digits)) + pattern.after;
}

/// Ways to write the range into the name: their first group is the range's first number, the second is its last one.
/// The rest of the name has a place for the number already where `has_token`.
struct RangeForm {
  const char* pattern;
  bool has_token;
};
constexpr RangeForm kRangeForms[] = {
    {R"([ ,]+[\[(]?(-?\d+)-(-?\d+(?:[x:]\d+)?)[\])]?$)", true},  // shot.####.exr 1001-1100
    {R"((\d+)-(\d+)(?=[#@]|%0?\d*d))", true},                    // shot.1001-1100#.exr
    {R"([\[{(](\d+)(?:-|\.\.)(\d+)[\])}])", false},              // shot.[1001-1100].exr, shot.{1001..1100}.exr
    {R"(([0-9]{2,})-([0-9]{2,})(?=\.\w+$))", false},             // shot.1001-1100.exr
};

std::string range_in(const std::string& name) {
  for (const auto& [pattern, has_token] : kRangeForms) {
    std::smatch found;
    if (!std::regex_search(name, found, std::regex(pattern))) continue;
    const std::string first = found[1], token = has_token ? "" : frame_token(first.size());
    return fmt::format("a range does not belong in the name: write {}{}{} with --frames {}-{}", found.prefix().str(),
                       token, found.suffix().str(), first, found[2].str());
  }
  return "";
}

std::string foreign_token_in(const std::string& name) {
  static const std::regex view(R"(%[vV]|<[Vv][Ii][Ee][Ww]>|\{view\}|\$\{?VIEW\}?)"),
      other(R"(%\d*[A-Za-z]|%\(\w+\)\d*[a-z]?|<\w+>|\$?\{\w*(:\w+)?\}|\$[A-Za-z_]\w*)");
  std::smatch found;
  if (std::regex_search(name, found, view))
    return fmt::format(
        "{} is not a pattern of Alcove: write a view's name in its place, such as left, and run each view by itself; "
        "of a file that holds several views, --view takes one",
        found.str());
  const std::string rest = std::regex_replace(name, std::regex("%(0\\d*)?d|<[Ff]\\d?>|\\$F\\d?"), "");
  if (std::regex_search(rest, found, other))
    return fmt::format(
        "{} is not a pattern of Alcove: write #### or %04d for a frame number, and the word itself for all else",
        found.str());
  return "";
}

/// What is left of a name without its ending, digits and separators, in small letters.
std::string core_of(const std::string& name) {
  std::string core;
  for (const char c : lower_case(fs::path(name).stem().string()))
    if (std::isalpha(static_cast<unsigned char>(c))) core += c;
  return core;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  std::ranges::sort(names);
  return names;
}

/// The number in a name between the beginning and the end of a pattern's; "" if something else stands there.
std::string number_in(const std::string& name, const std::string& before, const std::string& after) {
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return "";
  const std::string number = name.substr(before.size(), name.size() - before.size() - after.size());
  return number.find_first_not_of("0123456789") == number.npos ? number : "";
}

/// Names the files that differ from the pattern in the number of their digits, where none has as many as the pattern.
std::string other_digits(const std::vector<std::string>& names, const std::string& folder, const std::string& before,
                         const std::string& after, int own_digits) {
  std::map<std::size_t, std::string> first;  // by the number of digits
  for (const auto& name : names)
    if (const std::string number = number_in(name, before, after); !number.empty())
      first.try_emplace(number.size(), name);
  if (first.empty() || first.contains(std::size_t(own_digits))) return "";
  const auto& [digits, name] = *first.begin();
  return fmt::format("its number has {} digit{} in {}: write {}{}{}{}", digits, digits == 1 ? "" : "s", name, folder,
                     before, frame_token(digits), after);
}

/// Names a file that differs from the pattern in its ending, its separators or its letters' case.
std::string nearly_named(const std::vector<std::string>& names, const std::string& folder, const std::string& wanted) {
  const auto near = std::ranges::find_if(
      names, [&](const std::string& name) { return core_of(name) == core_of(wanted) && frame_number_in(name).number; });
  return near == names.end() ? "" : fmt::format("there is {}{}", folder, *near);
}

}  // namespace

std::string foreign_pattern_in(const std::string& name) {
  const std::string range = range_in(name);
  return range.empty() ? foreign_token_in(name) : range;
}

std::string why_no_frames(const FramePattern& pattern) {
  std::string why = foreign_pattern_in(text_of(pattern));
  const std::string folder = folder_prefix(pattern.before), before = pattern.before.substr(folder.size());
  const auto names = names_in(folder.empty() ? "." : folder);
  if (why.empty()) why = other_digits(names, folder, before, pattern.after, pattern.digits);
  if (why.empty()) why = nearly_named(names, folder, before + pattern.after);
  return why.empty() ? "" : ": " + why;
}

}  // namespace alcove
