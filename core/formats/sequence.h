// Names of files: patterns of frame sequences, their frames on the disk, numbers in names, and endings.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace alcove {

/// A file name with one place for the frame number, such as shot.%04d.exr.
struct FramePattern {
  std::string before, after;
  int digits = 1;  // the least number of characters, with a minus sign, filled with zeros (as printf's %04d)

  std::string path(int frame) const;
  bool operator==(const FramePattern&) const = default;
};

/// Gives the pattern in a path, or nothing without a token. Tokens: %d, %04d (up to 16 digits, as the next two); # (4
/// digits), ## and more (one digit each); @@ and more (one digit each; a lone @ is a letter); $F, $F4; <f>, <F>, <f4>,
/// <F4>. Fails with ErrorKind::usage if there are two tokens.
std::optional<FramePattern> frame_pattern(const std::string& path);

/// The token of numbers with so many digits: %d of one, ## and more of others.
std::string frame_token(std::size_t digits);

/// Gives the frames of a list such as "1001-1100x2,1200": single numbers, ranges a-b, and ranges with a step a-bxS or
/// a-b:S, separated by commas, blanks or both. Numbers may be negative (-5--1), and ranges may run backwards (10-1,
/// 10-1x2). Frames come in the order of the list, none twice. Fails with ErrorKind::usage, quoting the part, on
/// anything else, on a step of 0, and on more than 1,000,000 frames, repeated ones counted.
std::vector<int> parse_frames(const std::string& list);

/// Gives the frames of a pattern that lie on the disk, in rising order. Only names that the pattern itself makes count:
/// shot.00042.exr is not a frame of shot.%04d.exr. `option` is for the message. Fails with ErrorKind::input if the
/// folder cannot be read or holds no such file, and with ErrorKind::usage if the token is in the folder's name.
std::vector<int> frames_on_disk(const FramePattern& pattern, const char* option);

/// Gives the numbers that are left out of rising ones. Three or more that keep a step are rendered on every second or
/// third number; two tell of no step.
std::vector<int> holes_in(const std::vector<int>& frames);

/// The frame number in the name of a single file.
struct FrameNumber {
  std::optional<int> number;  // none: no number in the name is surely a frame's
  std::string digits;         // source of the number, or digits that may be one; "" for a version or a size
  std::string doubt;          // the reason why such digits do not count; "" without them
};

/// Looks at the last part of a path, without its ending. A number that stands by itself is a frame's if it comes last
/// (shot.0005, shot_5, 0005), stands between dots (shot.5.left) or has four digits (shot_0005_left); of several, the
/// last one counts. Four digits at the end of a word count too (shot0005). A version (v002), a size (1920x1080, 4k) and
/// a date do not count, nor do fewer digits at the end of a word, which may be a shot's (sh010).
FrameNumber frame_number_in(const std::string& path);

/// Explains a name without a file: it holds another program's token, or a range. "" if it holds neither.
std::string foreign_pattern_in(const std::string& name);

/// Explains a pattern without a file in the same way, or names the files that differ in digits, ending or separator.
/// Begins with ": "; "" if there is no explanation.
std::string why_no_frames(const FramePattern& pattern);

/// Fails with ErrorKind::usage if the name of an output, where it has one, has not the ending of `format`, such as
/// ".exr". A frame number or the suffix of a file in the making may follow the ending: ao.exr.0001, ao.exr.tmp.
void require_ending(const std::string& path, const char* option, const char* ending, const char* format);

}  // namespace alcove
