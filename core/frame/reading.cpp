// What follows from a reading: which meaning other frames take over, and the map from its values to depth.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/reading.h"

#include <algorithm>

namespace alcove {
namespace {

/// The largest finite half float.
constexpr double kLargestHalf = 65504;

}  // namespace

void read_like(Reading& reading, const Meaning& settled) {
  const DepthRange own = reading.depth_range;
  static_cast<Meaning&>(reading) = settled;
  reading.depth_range.near = own.near;
  reading.depth_range.far = own.far;
}

DepthMap depth_map_of(const Reading& reading) {
  const bool is_distance = reading.depth_kind == DepthKind::planar || reading.depth_kind == DepthKind::ray;
  const double sky = is_distance && reading.depth_is_half ? std::min(reading.sky, kLargestHalf) : reading.sky;
  return depth_map(reading.depth_kind, reading.depth_range, reading.position_space, reading.camera, reading.depth_scale,
                   sky);
}

DepthPrecision depth_precision_of(const Reading& reading) {
  return depth_precision(depth_map_of(reading), reading.depth_is_half ? kHalfPrecision : kFloatPrecision,
                         reading.depth_step);
}

}  // namespace alcove
