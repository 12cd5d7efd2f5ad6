// A floor with a block on it, and parallel views that lean from the floor's normal: where every expected value is known
// at every tilt.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

/// The floor z = 0, and a block of that height without end in y that covers x < 0.
inline Scene block(double height) {
  return {{Plane{.point = {}, .normal = {0, 0, 1}}, parallelogram({0, -100, 0}, {0, 200, 0}, {0, 0, height}),
           parallelogram({0, -100, height}, {0, 200, 0}, {-100, 0, 0})}};
}

/// A parallel view of the floor about (0.5, 0, 0), `units` wide, that leans from its normal towards x by an angle. The
/// block's edge is upright in the picture at a `turn` of 0, and turns with it.
inline Shot leaning(double tilt_degrees, double units, int width, int height, double turn_degrees = 0) {
  const double tilt = tilt_degrees * std::numbers::pi / 180, turn = turn_degrees * std::numbers::pi / 180;
  const Vec3 target{0.5, 0, 0}, right{std::cos(tilt), 0, -std::sin(tilt)}, up{0, 1, 0};
  Shot shot = Shot::orthographic(target + 60 * Vec3{std::sin(tilt), 0, std::cos(tilt)}, target, units, width, height);
  shot.right = std::cos(turn) * right + std::sin(turn) * up;
  shot.up = std::cos(turn) * up - std::sin(turn) * right;
  return shot;
}

}  // namespace alcove::test
