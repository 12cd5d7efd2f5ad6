// The frame number in a file's name, as people and programs write it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace alcove {

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

}  // namespace alcove
