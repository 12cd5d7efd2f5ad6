// The shift of disparity by which the planes of a picture meet at right angles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "core/frame/camera/camera.h"
#include "core/frame/evidence.h"

namespace alcove {

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
