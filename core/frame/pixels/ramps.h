// Ramps across outlines, which blurred depth has in the place of steps.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/frame/reading.h"

namespace alcove {

/// Where the reading cuts ramps, gives each of their pixels to the nearer or the farther surface: to the one whose
/// value is nearer, along the row or the column in which that is steeper. The pixel then lies on the plane through the
/// pixels about it on this surface and on no ramp. `depth` is over the whole data window, so that parts of a frame have
/// the bits of the whole. Fails with ErrorKind::usage for positions.
void cut_ramps(const Reading& reading, std::span<float> depth);
/// The same in a copy; empty where the reading cuts none.
std::vector<float> with_ramps_cut(const Reading& reading, std::span<const float> depth);

/// The bytes per pixel: four floats, one of them the copy for settling, and a bit.
constexpr std::uint64_t kRampBytes = 17;

}  // namespace alcove
