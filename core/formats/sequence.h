// Names of files: frame sequences and what of them lies on the disk, frame numbers, and endings.
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
  int digits = 1;  // at least that many characters, a minus sign among them, filled with zeros (as printf's %04d)

  std::string path(int frame) const;
  bool operator==(const FramePattern&) const = default;
};

/// Gives the pattern in a path, or nothing where it has no token. Tokens: %d, %04d (up to 16 digits, as the next two);
/// # (4 digits), ## and more (one digit each); @@ and more (one digit each; a lone @ is a letter); $F, $F4; <f>, <F>,
/// <f4>, <F4>. Fails with ErrorKind::usage when there are two tokens.
std::optional<FramePattern> frame_pattern(const std::string& path);

/// Gives the frames of a list such as "1001-1100x2,1200": single numbers, ranges a-b, ranges with a step a-bxS or
/// a-b:S, with commas, blanks or both between them. Numbers may be negative (-5--1), ranges may run backwards (10-1,
/// 10-1x2). They come in the order of the list, none twice. Fails with ErrorKind::usage, quoting the part, on anything
/// else, on a step of 0, and on more than 1,000,000 frames, repeated ones counted.
std::vector<int> parse_frames(const std::string& list);

/// Writes the shortest such list, in rising order: "1003, 1010-1012".
std::string frames_text(std::vector<int> frames);

/// Gives the frames of a pattern that lie on the disk, in rising order. Names are taken only where the pattern gives
/// them back: shot.00042.exr is no frame of shot.%04d.exr. Fails with ErrorKind::input when the folder cannot be read
/// or holds no such file, with ErrorKind::usage when the token is in the folder's name; `option` is for the message.
std::vector<int> frames_on_disk(const FramePattern& pattern, const char* option);

/// What the name of a single file tells of its frame.
struct FrameNumber {
  std::optional<int> number;  // none: the name has no number, or none that is surely a frame's
  std::string digits;         // from which the number was read, or which may be one
  std::string doubt;          // why these are not taken for a number; "" where there are none
};

/// Looks at the last part of a path, without its ending. A number that stands by itself is a frame's where it comes
/// last (shot.0005, shot_5, 0005), stands between dots (shot.5.left) or has four digits (shot_0005_left); of several
/// the last one counts. Four digits at the end of a word are one too (shot0005). A version (v002), a size (1920x1080,
/// 4k) and a date are none, and neither are fewer digits at the end of a word, which may be a shot's (sh010).
FrameNumber frame_number_in(const std::string& path);

/// Fails with ErrorKind::usage where the name of an output ends as if the file were of another format than `format`,
/// whose ending is `ending`, ".exr" say. A name without an ending is as good, and behind the ending there may be a
/// frame number or the suffix of a file in the making: ao.exr.0001, ao.exr.tmp.
void require_ending(const std::string& path, const char* option, const char* ending, const char* format);

}  // namespace alcove
