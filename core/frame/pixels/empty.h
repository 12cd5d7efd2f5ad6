// Parts of a picture without surfaces: along its borders, and as rectangles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/lines.h"
#include "core/frame/reading.h"

namespace alcove {

/// The rows and columns along the borders of a whole frame that have no surface.
Borders borders_of(std::span<const float> depth, const Window& window, const DepthMap& map);

/// The stretches of a row, and its place.
struct PlacedRuns {
  int row;
  std::vector<EmptyRun> runs;
};

/// The largest rectangle without surfaces that has one value and does not reach from border to border. `rows` are some
/// rows of the window, which may be a part of the frame: a rectangle that reaches beyond the part does not count.
/// `is_sky_0`: 0 means infinitely far, as in the sky elsewhere.
std::optional<EmptyRectangle> empty_rectangle(std::span<const float> depth, const Window& window, const Window& frame,
                                              std::span<const PlacedRuns> rows, bool is_sky_0 = false);

}  // namespace alcove
