// The camera of a frame whose file has a pass of positions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/frame/gbuffer.h"
#include "core/frame/resection.h"

namespace alcove {

/// The three channels of a frame's positions: those of its depth where they are positions, else those that stand beside
/// it in its file, by the option, as the rules name them, or by their usual names. None where there are none, or
/// their windows differ. They may have another window than the depth.
std::vector<ChannelRef> find_positions(const ChannelSearch& search, const FrameSource& source,
                                       const InputSettings& settings);

/// How many bands of rows are read of positions: to solve a camera, and to see whether one fits.
inline constexpr int kManyBands = 48, kFewBands = 4;

/// Up to 48 points of source.channels.positions in each band of rows, well spread over the picture: of each place the pixel
/// whose surroundings are smoothest, so that neither edges nor filters matter. Sky has none: 0, not finite, beyond
/// `sky`, or the same in all pixels about. Reads every part of the file's rows once, and no more of them than it needs.
std::vector<SeenPoint> points_of(FrameSource& source, double sky, int bands);

}  // namespace alcove
