// What is suspicious about a frame's depth, normals and files, beyond what reading them decided.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/frame/gbuffer.h"

namespace alcove {

/// Gives one sentence for each finding: anti-aliased depth, shortened normals, channels that a lossy codec has damaged,
/// other parts that are cut short or have other windows, overscan and crops. `depth` and `normal` are as read, of
/// source.data and of a frame whose meaning is settled; of large frames a part of the pixels is looked at.
Notes findings(FrameSource& source, std::span<const float> depth, std::span<const float> normal);

/// Whether the normals are vectors in x, y and z, which have a length to look at.
bool has_lengths(const FrameSource& source);

/// Gives the share of the rows' steps from one surface to another that take a pixel in between. It is near 0 for point
/// samples, near 1 where pixels were averaged, and 0 if there are too few steps to tell. `planar` is infinite on sky.
double blended_edges(std::span<const float> planar, int width);

}  // namespace alcove
