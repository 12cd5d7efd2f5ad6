// Motion vectors of a frame: the reading that the cameras prove, and the pixels that move by it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/frame/camera/camera.h"

namespace alcove {

/// Motion vectors as they were read. Files with vectors to both the previous and the next frame hold two pairs.
struct MotionPlanes {
  struct Pair {
    std::vector<float> x, y;
  };
  std::string path;
  std::vector<Pair> pairs;
};

/// Reads the vectors that the settings name. `data` is the window of the frame. Fails with ErrorKind::input if there
/// are none, or if they lie over other pixels.
MotionPlanes read_motion(const InputSettings& settings, const Window& data);

/// Another frame of the shot as this one's pixels are seen from it.
struct FromThere {
  ViewMap map{};  // this frame's view space -> its own
  View view{};    // of its camera, over this frame's pixels
};

/// A frame, and the two beside it.
struct MotionFrame {
  std::span<const float> depth;  // planar; kSkyDepth for sky
  View view{};
  std::optional<FromThere> previous, next;  // none at the ends of the shot
};

/// A way to read vectors, each the place of a surface in another frame less its place in this one.
struct MotionReading {
  std::size_t pair = 0;
  MotionKind kind = MotionKind::previous;  // not automatic
  std::array<double, 2> scale{};           // px per unit, x to the right and y down
  double share = 0;                        // of the surfaces that stand still by it
};

/// Gives the reading by which the most surfaces stand still: vectors may have either sign, y up or down, and be in
/// pixels, in parts of the picture, or in parts of its half. None if no reading fits more than a few: then the vectors
/// have another unit or belong to other frames. `kind` may fix the frame to which they point.
std::optional<MotionReading> best_motion_reading(const MotionPlanes& planes, const MotionFrame& frame, MotionKind kind);

/// Gives 1 for each pixel with a surface that moves by its vector, and for pixels up to `around` px beside it; else 0.
/// Sky stands still.
std::vector<std::uint8_t> moving_by(const MotionPlanes& planes, const MotionReading& reading, const MotionFrame& frame,
                                    int around = 1);

}  // namespace alcove
