// Flicker: how much the error of a sequence changes from frame to frame.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace alcove {

/// The errors of one frame of a sequence. All planes are of one size, row by row.
struct ErrorFrame {
  int width = 0, height = 0;
  std::vector<float> error;        // result - reference; one or several planes
  std::vector<float> error_b;      // result - a second, independently noisy reference; empty where there is none
  std::vector<std::uint8_t> mask;  // one per pixel; 0 where it does not count
  std::vector<float> depth;        // empty: not known
  // The place in the previous frame minus the place here, in pixels, y up (as Blender's Vector); empty: nothing moves.
  std::vector<float> motion_x, motion_y;
};

/// The root mean square of error(here) - error(previous frame, same surface): 0 for an error that stays where it is on
/// a surface, and for any movement that the reference makes too. With two references it is free of their noise, as
/// that of compare_planes() is.
///
/// With motion, the same surface is at the pixel that is nearest to the motion's place. That pixel is taken as it is,
/// since interpolation would hide noise. A pixel is left out where it or its earlier place does not count or is
/// outside, where the motion is not finite, and where the two depths differ by more than kDepthStep.
class Flicker {
 public:
  /// Adds two consecutive frames, of one size and with the same planes.
  void add(const ErrorFrame& previous, const ErrorFrame& here);
  std::size_t count() const { return count_; }
  /// 0 where nothing was added.
  double rms() const;

 private:
  double square_ = 0;
  std::size_t count_ = 0;
};

}  // namespace alcove
