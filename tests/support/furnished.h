// A furnished room as a rendering, and the depths that other programs would have written of it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

constexpr double kNear = 0.1;  // of its z-buffers, scene units

/// A floor, a wall and a ball, from outside or from within a corner, with sky.
inline Rendering furnished(bool inside = false) {
  const Scene scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
                     Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
  return render(scene, inside ? Shot::perspective({0.3, -0.5, 0.2}, {1, 0.6, 0.3}, 90, 160, 120)
                              : Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, 55, 160, 120));
}

/// The frame with each depth of a surface replaced, and all sky by `sky`.
inline HostFrame with_depth(const Rendering& rendering, DepthKind kind, const std::function<double(const Hit&)>& value,
                            float sky) {
  HostFrame frame = rendering.frame;
  frame.depth_kind = kind;
  for (std::size_t i = 0; i < frame.depth.size(); i++)
    frame.depth[i] = rendering.hits[i].primitive < 0 ? sky : float(value(rendering.hits[i]));
  return frame;
}

/// The z-buffer by its projection matrix: the third row over the fourth, for a camera that looks along -z.
inline double device_depth(double z, double far, bool reversed, DeviceRange device, double near = kNear) {
  const double zero_to_one = std::isinf(far) ? 1 - near / z : (far / (far - near)) * (1 - near / z);
  const double d = reversed ? 1 - zero_to_one : zero_to_one;
  return device == DeviceRange::zero_to_one ? d : 2 * d - 1;
}

inline DepthRange between_planes(double far, bool reversed, DeviceRange device = DeviceRange::zero_to_one,
                                 double near = kNear) {
  DepthRange range;
  range.near = near;
  range.far = far;
  range.reversed = reversed;
  range.device = device;
  return range;
}

}  // namespace alcove::test
