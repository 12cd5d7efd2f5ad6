// Places of a picture: pixels, the rays through them, and the points that depth gives them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// The step between places: about 112 of them lie along the longer side, enough for shares to a percent.
inline int sparseness(const View& view) {
  constexpr int kAcross = 112;
  return std::max(1, std::max(view.size.x, view.size.y) / kAcross);
}

inline std::size_t index_of(const View& view, int x, int y) {
  return std::size_t(y) * std::size_t(view.size.x) + std::size_t(x);
}

/// Gives the point where the pixel's ray meets the plane at unit depth; orthographic: the pixel's place in the plane.
inline Vector3 tangent_at(const View& view, int x, int y) {
  return {(x + 0.5 - view.center.x) * view.tangent_per_pixel.x, (y + 0.5 - view.center.y) * view.tangent_per_pixel.y,
          -1};
}

/// The value of a pixel: one, or a position's three.
inline Vector3 value_at(std::span<const float> raw, std::size_t plane, std::size_t i) {
  return raw.size() == 3 * plane ? Vector3{raw[i], raw[i + plane], raw[i + 2 * plane]} : Vector3{raw[i], 0, 0};
}

/// The planar depth of a pixel; infinite where it shows no surface.
inline double planar_depth_at(const DepthMap& map, std::span<const float> raw, const View& view, int x, int y) {
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  return planar_depth(map, value_at(raw, plane, index_of(view, x, y)), map.along_ray ? ray_length(view, x, y) : 1);
}

}  // namespace alcove
