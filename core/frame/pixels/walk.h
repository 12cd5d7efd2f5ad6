// The walk over the pixels of a frame: rows and columns all over the picture, in parallel.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/lines.h"
#include "core/frame/reading.h"

namespace alcove {

/// The planes that are walked over, as in the file, over a window, and how they are read.
struct WalkedPlanes {
  const Reading& reading;  // over that window
  Window frame;            // all pixels that the files hold
  std::span<const float> depth, normal;
  bool has_read_normals = false;  // the reading of the normals is settled, too
};

/// Samples rows and columns, and fills in their findings. The result does not depend on the number of threads.
void walk(const WalkedPlanes& planes, Findings& findings);

// Parts of a picture without surfaces.

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
