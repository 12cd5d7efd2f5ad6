// What follows from a reading: which meaning other frames take over, and the map from its values to depth.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/reading.h"

#include <algorithm>

#include "core/base/windows.h"

namespace alcove {
namespace {

/// Raw depth at or beyond it is sky. Values that passed through half floats end where those end. `found`: the sky that
/// the pixels show, of distances.
double sky_of(DepthKind kind, bool is_half, double sky, double found = std::numeric_limits<double>::infinity()) {
  if (kind != DepthKind::planar && kind != DepthKind::ray) return sky;
  return std::min({sky, found, is_half ? kLargestHalf : sky});
}

}  // namespace

bool list_all(std::span<const BehindPlane> planes) {
  return std::ranges::all_of(
      planes, [](const BehindPlane& plane) { return plane.kind == BehindKind::surfaces && plane.is_whole; });
}

Window picture_of(const Reading& reading, const Window& part) {
  return reduced(part, reading.display, reading.supersampling);
}

void read_like(Reading& reading, const Meaning& settled) {
  const DepthRange own = reading.depth_range;
  static_cast<Meaning&>(reading) = settled;
  reading.depth_range.near = own.near;
  reading.depth_range.far = own.far;
}

DepthMap depth_map_of(const Reading& reading) {
  return depth_map(reading.depth_kind, reading.depth_range, reading.position_space, reading.camera, reading.depth_scale,
                   sky_of(reading.depth_kind, reading.depth_is_half, reading.sky, reading.found_sky));
}

DepthMap behind_map_of(const Reading& reading, const BehindPlane& plane) {
  const bool is_own = plane.depth_kind == DepthKind::automatic;
  const bool is_length = is_own && (plane.kind == BehindKind::thickness || reading.depth_kind == DepthKind::position);
  DepthKind kind = is_own ? reading.depth_kind : plane.depth_kind;
  if (is_length && kind != DepthKind::ray) kind = DepthKind::planar;
  return depth_map(kind, is_own && !is_length ? reading.depth_range : DepthRange{}, reading.position_space,
                   reading.camera, is_own ? reading.depth_scale : plane.scale,
                   sky_of(kind, plane.is_half, reading.sky));
}

DepthPrecision hidden_precision_of(const Reading& reading) {
  Reading coarsest = reading;
  for (const auto& plane : reading.behind) coarsest.depth_is_half |= plane.is_half;
  return depth_precision_of(coarsest);
}

bool has_coarse_depth(const Reading& reading) { return reading.depth_is_half || reading.depth_is_coarse; }

DepthPrecision depth_precision_of(const Reading& reading) {
  const double of_type = reading.depth_is_half ? kHalfPrecision : kFloatPrecision;
  return depth_precision(depth_map_of(reading), std::max(of_type, reading.depth_rounding), reading.depth_step);
}

}  // namespace alcove
