// The shift of disparity by which a frame's depth agrees with its normals, or its planes meet at right angles. Knows no
// network.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/frame/pixels/normal_scores.h"
#include "core/frame/reading.h"

namespace alcove {

/// The shift b of disparity d = a / z + b by one reading of the normals.
struct ShiftScore {
  NormalSpace space;
  NormalFlips flips;
  double shift = 0;
  double error = 0;      // it lies within so much of that
  double agreement = 0;  // the part of the disparity's slopes that it explains, at most 1; 0 and less: none
};

/// Gives the shift by each reading of the normals, the best agreement first; nothing where too few places show one.
/// Opposite normals are one reading. `grain` is that of the disparity.
///
/// On a plane 1/z is in proportion to s = normal * ray, so two of its pixels p and q give b: (d_q - b) s_p = (d_p - b)
/// s_q. The scale a drops out. All pairs together give b by their weighted median.
std::vector<ShiftScore> score_shifts(const NormalPlanes& planes, const Grain& grain);

struct RightAngles {
  double shift = 0, error = 0;
};
/// Gives the shift that makes the most pairs of planes perpendicular, where these are many and three planes are
/// perpendicular to each other. Planes are planes with any shift, so nothing else of them tells it; and a scene
/// without right angles may still have such a shift, so that this proves nothing.
///
/// Over a plane's picture disparity is affine: d = p X + q Y + r of the ray (X, Y, -1). With the shift b its normal is
/// along (p, q, b - r), so two planes that are perpendicular give b by p p' + q q' + (r - b) (r' - b) = 0.
std::optional<RightAngles> shift_by_right_angles(const View& view, std::span<const float> raw, const Grain& grain);

}  // namespace alcove
