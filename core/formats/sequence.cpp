// Tokens, ranges, directory listings, numbers in names, endings, and names without a file.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <map>
#include <numeric>
#include <regex>
#include <sstream>
#include <unordered_set>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {

namespace {

namespace fs = std::filesystem;

constexpr long kMostFrames = 1'000'000;
constexpr long kFrameLimit = 1'000'000'000;  // frame numbers lie nearer to 0: they have 9 digits at most
constexpr int kMostPadding = 16;

/// A place for the frame number in a path.
struct Token {
  std::size_t begin = 0, end = 0;
  int digits = 1;
};

/// Reads the digit at `at`, if there is one, and moves `at` behind it.
std::optional<int> digit(const std::string& text, std::size_t& at) {
  if (at >= text.size() || text[at] < '0' || text[at] > '9') return std::nullopt;
  return text[at++] - '0';
}

/// Gives the token that begins at `begin`.
std::optional<Token> token_at(const std::string& path, std::size_t begin) {
  const char kind = path[begin];
  std::size_t end = begin + 1;
  const auto ends_with = [&](char last) { return end < path.size() && path[end++] == last; };
  if (kind == '#' || kind == '@') {
    end = std::min(path.find_first_not_of(kind, begin), path.size());
    const int length = int(end - begin);
    if (length > kMostPadding || path.substr(begin, end - begin) == "@") return std::nullopt;
    return Token{begin, end, kind == '#' && length == 1 ? 4 : length};
  }
  if (kind == '%') {
    int digits = 0;
    if (end < path.size() && path[end] == '0')
      for (auto next = digit(path, end); next; next = digit(path, end))
        digits = std::min(10 * digits + *next, kMostPadding + 1);
    return ends_with('d') && digits <= kMostPadding ? std::optional(Token{begin, end, std::max(1, digits)})
                                                    : std::nullopt;
  }
  if (kind != '$' && kind != '<') return std::nullopt;
  if (!ends_with('F') && !(kind == '<' && path[end - 1] == 'f')) return std::nullopt;
  const int digits = std::max(1, digit(path, end).value_or(1));
  return kind == '$' || ends_with('>') ? std::optional(Token{begin, end, digits}) : std::nullopt;
}

std::optional<Token> find_token(const std::string& path, std::size_t from) {
  for (std::size_t begin = from; begin < path.size(); begin++) {
    if (const auto token = token_at(path, begin)) return token;
    // A part of a run of # or @ is no token.
    if (path[begin] == '#' || path[begin] == '@')
      begin = std::min(path.find_first_not_of(path[begin], begin), path.size()) - 1;
  }
  return std::nullopt;
}

/// A range of a list: a, a-b, a-bxS or a-b:S.
struct Range {
  long first = 0, last = 0, step = 1;
};

std::optional<Range> range_of(const std::string& text, const std::string& list) {
  const char *at = text.data(), *end = at + text.size();
  const auto number = [&](long& value) {
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error == std::errc::result_out_of_range || value <= -kFrameLimit || value >= kFrameLimit)
      fail(ErrorKind::usage, "--frames {}: {} is too far from 0: numbers have 9 digits at most", list,
           std::string(at, stop));
    at = stop;
    return error == std::errc();
  };
  Range range;
  if (!number(range.first)) return std::nullopt;
  range.last = range.first;
  if (at == end) return range;
  if (*at++ != '-' || !number(range.last)) return std::nullopt;
  if (at == end) return range;
  if ((*at != 'x' && *at != ':') || !number((at++, range.step)) || at != end) return std::nullopt;
  return range;
}

/// Adds one part of a list. `list` is for messages. `listed` counts frames, repeated ones too.
void add_part(const std::string& text, const std::string& list, std::vector<int>& frames,
              std::unordered_set<int>& distinct, long& listed) {
  const auto range = range_of(text, list);
  if (!range)
    fail(ErrorKind::usage,
         "--frames {}: \"{}\" is no frame and no range; write 1001, 1001-1100 or 1001-1100x2, with commas between",
         list, text);
  const auto [first, last, step] = *range;
  if (step == 0) fail(ErrorKind::usage, "--frames {}: the step of {} is 0", list, text);
  if (step < 0 && last > first)
    fail(ErrorKind::usage, "--frames {}: {} runs forwards, and its step backwards", list, text);
  const long stride = last >= first ? step : -std::abs(step);
  listed += std::abs(last - first) / std::abs(stride) + 1;
  if (listed > kMostFrames)
    fail(ErrorKind::usage, "--frames {}: with {} there are more than {} frames", list, text, kMostFrames);
  for (long frame = first; stride > 0 ? frame <= last : frame >= last; frame += stride)
    if (distinct.insert(int(frame)).second) frames.push_back(int(frame));
}

/// Gives the frame with this path.
std::optional<int> frame_of(const FramePattern& name, const std::string& text) {
  if (text.size() <= name.before.size() + name.after.size() || !text.starts_with(name.before) ||
      !text.ends_with(name.after))
    return std::nullopt;
  int frame = 0;
  const char* begin = text.data() + name.before.size();
  const char* end = text.data() + text.size() - name.after.size();
  const auto [stop, error] = std::from_chars(begin, end, frame);
  if (error != std::errc() || stop != end || std::abs(long(frame)) > kFrameLimit || name.path(frame) != text)
    return std::nullopt;
  return frame;
}

/// Whether an ending, without its dot, says nothing about the format.
bool is_passed_over(const std::string& ending) {
  static constexpr std::array kOfUnfinished = {"tmp", "temp", "part", "partial", "new"};
  return ending.find_first_not_of("-0123456789") == ending.npos ||
         std::ranges::find(kOfUnfinished, ending) != kOfUnfinished.end();
}

/// The ending of a name, with its dot and in small letters; passed-over endings behind it do not count. "" if there is
/// none.
std::string ending_of(const std::string& path) {
  std::filesystem::path name = std::filesystem::path(path).filename();
  while (name.has_extension() && is_passed_over(lower_case(name.extension().string().substr(1)))) name = name.stem();
  return lower_case(name.extension().string());
}

}  // namespace

std::string FramePattern::path(int frame) const { return fmt::format("{}{:0{}}{}", before, frame, digits, after); }

std::optional<FramePattern> frame_pattern(const std::string& path) {
  const auto token = find_token(path, 0);
  if (!token) return std::nullopt;
  const auto text_of = [&](const Token& t) { return path.substr(t.begin, t.end - t.begin); };
  if (const auto second = find_token(path, token->end))
    fail(ErrorKind::usage, "{}: there are two places for the frame number, {} and {}; there may be one", path,
         text_of(*token), text_of(*second));
  return FramePattern{path.substr(0, token->begin), path.substr(token->end), token->digits};
}

std::string frame_token(std::size_t digits) { return digits == 1 ? "%d" : std::string(digits, '#'); }

std::vector<int> parse_frames(const std::string& list) {
  std::vector<int> frames;
  std::unordered_set<int> distinct;
  long listed = 0;
  std::istringstream parts(list + ",");
  for (std::string part; std::getline(parts, part, ',');) {
    std::istringstream words(part);
    std::string word;
    if (!(words >> word))
      fail(ErrorKind::usage, "--frames {}: the list is empty, or has nothing between two commas", list);
    do add_part(word, list, frames, distinct, listed);
    while (words >> word);
  }
  return frames;
}

std::vector<int> frames_on_disk(const FramePattern& pattern, const char* option) {
  if (fs::path(pattern.after).has_parent_path())
    fail(ErrorKind::usage, "{}: {}: the frame number is in a folder's name: say which frames with --frames", option,
         pattern.path(0));
  const std::string above = folder_prefix(pattern.before), folder = above.empty() ? "." : above;
  const FramePattern name{pattern.before.substr(above.size()), pattern.after, pattern.digits};
  std::error_code error;
  std::vector<int> frames;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (const auto frame = frame_of(name, entry->path().filename().string())) frames.push_back(*frame);
  if (error)
    fail(ErrorKind::input, "{}: the folder {} cannot be read: {}{}", option, folder, error.message(),
         why_no_frames(pattern));
  if (frames.empty())
    fail(ErrorKind::input, "{}: there is no frame such as {}{}", option, pattern.path(1), why_no_frames(pattern));
  std::ranges::sort(frames);
  return frames;
}

namespace {

// One file with a far number would list millions of missing frames.
constexpr std::size_t kMostHoles = 1'000'000;

}  // namespace

std::vector<int> holes_in(const std::vector<int>& frames) {
  int step = 0;
  for (std::size_t i = 1; i < frames.size(); i++) step = std::gcd(step, frames[i] - frames[i - 1]);
  if (frames.size() < 3) step = 1;
  std::vector<int> holes;
  for (std::size_t i = 1; i < frames.size(); i++)
    for (int frame = frames[i - 1] + step; frame < frames[i] && holes.size() < kMostHoles; frame += step)
      holes.push_back(frame);
  return holes;
}

void require_ending(const std::string& path, const char* option, const char* ending, const char* format) {
  if (path.empty() || ending_of(path) == ending) return;
  fail(ErrorKind::usage, "{}: {} writes only {}: let its name end in {}", path, option, format, ending);
}

namespace {

constexpr const char* kDigits = "0123456789";
constexpr const char* kSeparators = "._- ";
constexpr std::size_t kUsualDigits = 4;  // of a frame's number, if nothing else tells
constexpr std::size_t kMostDigits = 9;   // longer numbers are dates, times or hashes

/// A word between separators.
struct Part {
  std::string text;
  char before, after;  // the separators beside it; 0 at the ends of the name
  bool is_negative;    // a minus sign stands before it
};

bool is_digits(const std::string& text) { return !text.empty() && text.find_first_not_of(kDigits) == text.npos; }

/// The digits at the end of a word: "0005" of "shot0005"; "" if there are none.
std::string digits_at_end(const std::string& text) {
  const std::size_t last = text.find_last_not_of(kDigits);
  return last == text.npos ? text : text.substr(last + 1);
}

bool is_version(const std::string& text) {
  const std::string word = lower_case(text.substr(0, text.size() - digits_at_end(text).size()));
  return text.size() > word.size() && (word.ends_with("v") || word == "ver" || word == "version");
}

/// Whether a word is a size, such as "1920x1080".
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

/// Whether a number by itself is surely that of a frame. `before` holds the parts before it.
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

/// Looks at the last word of a name in which no number stands by itself.
FrameNumber at_end_of_word(const Part& part) {
  const std::string digits = digits_at_end(part.text);
  if (digits.empty() || is_size(part.text) || digits.size() > kMostDigits) return {};
  if (is_version(part.text)) return {{}, "", fmt::format("{} is a version", part.text)};
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

// Names without a file: tokens and ranges of other programs, and files whose names differ in little.

namespace {

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
      other(R"(%\d*[A-Za-z]|%\d+(?![0-9A-Za-z])|%\(\w+\)\d*[a-z]?|<\w+>|\$?\{\w*(:\w+)?\}|\$[A-Za-z_]\w*)");
  std::smatch found;
  if (std::regex_search(name, found, view))
    return fmt::format(
        "{} is not a pattern of Alcove: write a view's name in its place, such as left, and run each view by itself; "
        "of a file that holds several views, --view takes one",
        found.str());
  const std::string rest = std::regex_replace(name, std::regex("%20|%(0\\d*)?d|<[Ff]\\d?>|\\$F\\d?"), "");
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
  return fmt::format("its number has {} in {}: write {}{}{}{}", counted(digits, "digit"), name, folder, before,
                     frame_token(digits), after);
}

/// Names a file that differs from the pattern in its ending, its separators or its letters' case; else one that differs
/// in few letters.
std::string nearly_named(std::vector<std::string> names, const std::string& folder, const std::string& wanted) {
  constexpr std::size_t kLeastLetters = 4, kMostLonger = 2;
  const std::string core = core_of(wanted);
  const auto is_far = [&](const std::string& name) {
    const std::string other = core_of(name);
    const auto [fewer, more] = std::minmax({other.size(), core.size()});
    return !frame_number_in(name).number || (other != core && (more < kLeastLetters || more - fewer > kMostLonger));
  };
  std::erase_if(names, is_far);
  std::vector<std::string> cores;
  std::ranges::transform(names, std::back_inserter(cores), core_of);
  const auto nearest = nearest_names(core, cores, 1);
  return nearest.empty() ? "" : fmt::format("there is {}{}", folder, *std::ranges::find(names, nearest[0], core_of));
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
