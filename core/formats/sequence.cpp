// Tokens, ranges, directory listings and endings.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sequence.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <sstream>
#include <unordered_set>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

constexpr long kMostFrames = 1'000'000;
constexpr long kFrameLimit = 1'000'000'000;  // all frame numbers are nearer to 0
constexpr int kMostDigits = 16;

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
    if (length > kMostDigits || path.substr(begin, end - begin) == "@") return std::nullopt;
    return Token{begin, end, kind == '#' && length == 1 ? 4 : length};
  }
  if (kind == '%') {
    int digits = 0;
    if (end < path.size() && path[end] == '0')
      for (auto next = digit(path, end); next; next = digit(path, end))
        digits = std::min(10 * digits + *next, kMostDigits + 1);
    return ends_with('d') && digits <= kMostDigits ? std::optional(Token{begin, end, std::max(1, digits)})
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

/// A range as it is written: a, a-b, a-bxS or a-b:S.
struct Range {
  long first = 0, last = 0, step = 1;
};

std::optional<Range> range_of(const std::string& text) {
  const char *at = text.data(), *end = at + text.size();
  const auto number = [&](long& value) {
    const auto [stop, error] = std::from_chars(at, end, value);
    at = stop;
    return error == std::errc() && -kFrameLimit < value && value < kFrameLimit;
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

/// Adds one part of a list, which is for messages. `listed` counts frames as often as they are there.
void add_part(const std::string& text, const std::string& list, std::vector<int>& frames,
              std::unordered_set<int>& known, long& listed) {
  const auto range = range_of(text);
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
    if (known.insert(int(frame)).second) frames.push_back(int(frame));
}

/// Gives the frame whose path this is.
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

/// The ending of the name with its dot, in small letters, behind which others may be passed over; "" where there is
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

std::vector<int> parse_frames(const std::string& list) {
  std::vector<int> frames;
  std::unordered_set<int> known;
  long listed = 0;
  std::istringstream parts(list + ",");
  for (std::string part; std::getline(parts, part, ',');) {
    std::istringstream words(part);
    std::string word;
    if (!(words >> word))
      fail(ErrorKind::usage, "--frames {}: the list is empty, or has nothing between two commas", list);
    do add_part(word, list, frames, known, listed);
    while (words >> word);
  }
  return frames;
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

std::vector<int> frames_on_disk(const FramePattern& pattern, const char* option) {
  namespace fs = std::filesystem;
  if (pattern.after.find('/') != pattern.after.npos)
    fail(ErrorKind::usage, "{}: {}: the frame number is in a folder's name: say which frames with --frames", option,
         pattern.path(0));
  const std::size_t slash = pattern.before.rfind('/');
  const std::string folder = slash == pattern.before.npos ? "." : pattern.before.substr(0, slash + 1);
  const FramePattern name{pattern.before.substr(slash + 1), pattern.after, pattern.digits};  // npos + 1 is 0
  std::error_code error;
  std::vector<int> frames;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (const auto frame = frame_of(name, entry->path().filename().string())) frames.push_back(*frame);
  if (error) fail(ErrorKind::input, "{}: the folder {} cannot be read: {}", option, folder, error.message());
  if (frames.empty()) fail(ErrorKind::input, "{}: there is no frame such as {}", option, pattern.path(1));
  std::ranges::sort(frames);
  return frames;
}

void require_ending(const std::string& path, const char* option, const char* ending, const char* format) {
  const std::string found = ending_of(path);
  if (found.empty() || found == ending) return;
  fail(ErrorKind::usage, "{}: {} writes {} and nothing else: let its name end in {}", path, option, format, ending);
}

}  // namespace alcove
