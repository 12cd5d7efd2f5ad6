// The coefficients of the map from each kind of depth, and what follows from a reading.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/reading.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/option_words.h"
#include "kernels/geometry/geometry.h"

namespace alcove {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double near_of(DepthKind kind, const DepthRange& range) {
  if (!range.near)
    fail(ErrorKind::usage, "{} depth needs the distance of the near plane: give --near{}", word_of(kind),
         range.far ? "" : ", and --far, which is inf where there is no far plane");
  return *range.near;
}

double far_of(DepthKind kind, const DepthRange& range, bool may_be_infinite) {
  if (!range.far)
    fail(ErrorKind::usage, "{} depth needs the distance of the far plane: give --far{}", word_of(kind),
         may_be_infinite ? ", --far inf where there is none" : "");
  if (std::isinf(*range.far) && !may_be_infinite)
    fail(ErrorKind::usage, "{} depth needs a finite --far", word_of(kind));
  return *range.far;
}

/// Counts only values strictly between the near and the far plane's as surfaces. `from` is the one of the two that
/// depths are counted from.
void count_between(DepthMap& map, double near_value, double far_value, double from) {
  map.sky_below = std::min(near_value, far_value);
  map.sky_above = std::max(near_value, far_value);
  map.origin = from;
}

/// Sets the map of a z-buffer. Depth is counted from the far plane, where perspective depth is densest: the difference
/// is exact there, and 1 minus it would not be.
void set_device(DepthMap& map, const DepthRange& range, const Camera& camera, double scale) {
  const bool orthographic = camera.orthographic;
  if (!range.near && camera.matrix_near_opengl)
    fail(ErrorKind::usage,
         "device depth needs the distance of the near plane: give --near, or --set device-range; the camera file's "
         "projection has it at {:.4g} if its z is 0 to 1 (device-range=0..1), and at {:.4g} if it is OpenGL's "
         "(device-range=-1..1)",
         *camera.matrix_near, *camera.matrix_near_opengl);
  const double n = near_of(DepthKind::device, range);
  if (!(n > 0) && !orthographic) fail(ErrorKind::usage, "device depth needs a near plane above 0, and --near is {}", n);
  const double f = far_of(DepthKind::device, range, !orthographic);
  if (!(n < f))
    fail(ErrorKind::usage, "the near plane must be nearer than the far plane, --near {} is not below --far {}", n, f);
  const double low = range.device == DeviceRange::minus_one_to_one ? -1 : 0;
  const double near_value = range.reversed ? 1 : low;
  const double far_value = range.reversed ? low : 1;
  count_between(map, near_value, far_value, far_value);
  map.form = orthographic ? kDepthLinear : kDepthReciprocal;
  const double at_near = orthographic ? n * scale : 1 / (n * scale);
  const double at_far = orthographic ? f * scale : 1 / (f * scale);
  map.base = at_far;
  map.slope = (at_near - at_far) / (near_value - far_value);
}

void set_normalized(DepthMap& map, const DepthRange& range, double scale, double sky) {
  const double n = range.near.value_or(0);
  const double f = far_of(DepthKind::normalized, range, false);
  if (!(n < f))
    fail(ErrorKind::usage, "the near plane must be nearer than the far plane, --near {} is not below --far {}", n, f);
  const double near_value = range.reversed ? 1 : 0;
  count_between(map, near_value, 1 - near_value, near_value);
  map.base = n * scale;
  map.slope = (f - n) * scale * (1 - 2 * near_value);
  if (range.reversed ? range.goes_beyond_far : range.goes_before_near) map.sky_below = -kInfinity;
  if (range.reversed ? range.goes_before_near : range.goes_beyond_far) map.sky_above = sky;
}

void set_log(DepthMap& map, const DepthRange& range, double scale) {
  const double near_value = range.reversed ? 1 : 0;
  count_between(map, near_value, 1 - near_value, near_value);
  map.form = kDepthExponential;
  map.base = scale / range.log_constant;
  map.slope = std::log1p(range.log_constant * far_of(DepthKind::log, range, false)) * (1 - 2 * near_value);
}

/// Sets the map of disparity whose scale and shift are settled.
void set_disparity(DepthMap& map, const DepthRange& range, double scale) {
  const Disparity disparity = disparity_of(range);
  if (!disparity.shift) fail(ErrorKind::usage, "disparity needs b, the value at infinity: give --set disparity-shift");
  map.form = kDepthReciprocal;
  map.origin = *disparity.shift;
  map.slope = 1 / (disparity.scale.value_or(1) * scale);
  map.sky_below = -kInfinity;  // what is beyond the sky is told by its distance
  map.sky_depth = std::min(map.sky_depth, 1 / (map.slope * range.disparity_error));
}

void set_position(DepthMap& map, PositionSpace space, bool negative, const Camera& camera, double scale) {
  map.form = kDepthPosition;
  map.sky_below = -kInfinity;
  if (space == PositionSpace::view) {
    map.axis = {0, 0, negative != camera.left_handed ? scale : -scale};
    return;
  }
  if (!camera.view_from_world)
    fail(ErrorKind::usage,
         "world positions need a camera with world_to_camera: give a --camera file with it, or --set "
         "position-space=view");
  for (std::size_t i = 0; i < 3; i++) map.axis[i] = -scale * (*camera.view_from_world)[2][i];
  map.base = -camera.view_from_world_offset[2];
  const auto& offset = camera.view_from_world_offset;
  map.eye_distance = std::hypot(offset[0], offset[1], offset[2]);
}

/// Raw depth at or beyond it is sky. Values that passed through half floats end where those end. `found`: the sky that
/// the pixels show, of distances.
double sky_of(DepthKind kind, bool is_half, double sky, double found = kInfinity) {
  if (!is_distance(kind)) return sky;
  return std::min({sky, found, is_half ? kLargestHalf : sky});
}

}  // namespace

Disparity disparity_of(const DepthRange& range) {
  Disparity found{range.disparity_scale, range.disparity_shift};
  auto& [scale, shift] = found;
  const double of_near = range.near ? 1 / *range.near : 0, of_far = range.far ? 1 / *range.far : 0;
  if (range.near && range.far) scale = 1 / (of_near - of_far);
  if (range.near && !range.far && shift) scale = (1 - *shift) / of_near;
  if (range.far && !range.near && shift) scale = -*shift / of_far;
  if (range.far && scale) shift = -*scale * of_far;
  if (range.near && !range.far && scale) shift = 1 - *scale * of_near;
  if (scale && !(*scale > 0 && std::isfinite(*scale)))
    fail(ErrorKind::usage,
         "disparity {} is 1 at --near and 0 at --far, and no scale above 0 fits: give other distances",
         shift ? fmt::format("with the shift {:.4g}", *shift) : "");
  return found;
}

DepthMap depth_map(DepthKind kind, const DepthRange& range, PositionSpace space, const Camera& camera, double scale,
                   double sky) {
  DepthMap map;
  map.sky_depth = sky * scale;
  switch (kind) {
    case DepthKind::automatic:
    case DepthKind::planar:
    case DepthKind::ray:
    case DepthKind::inverse:
      map.form = kind == DepthKind::inverse ? kDepthReciprocal : kDepthLinear;
      map.along_ray = kind == DepthKind::ray && !camera.orthographic;
      map.slope = (range.negative ? -1 : 1) * (kind == DepthKind::inverse ? 1 / scale : scale);
      if (kind != DepthKind::inverse) map.sky_above = sky;
      if (range.negative) {  // what is beyond the sky is told by its distance
        map.sky_below = -kInfinity;
        map.sky_above = 0;
      }
      break;
    case DepthKind::device: set_device(map, range, camera, scale); break;
    case DepthKind::normalized: set_normalized(map, range, scale, sky); break;
    case DepthKind::log: set_log(map, range, scale); break;
    case DepthKind::disparity: set_disparity(map, range, scale); break;
    case DepthKind::position: set_position(map, space, range.negative, camera, scale); break;
  }
  return map;
}

double planar_depth(const DepthMap& map, const std::array<double, 3>& raw, double ray_length) {
  double z = 0;
  if (map.form == kDepthPosition) {
    if (raw[0] == 0 && raw[1] == 0 && raw[2] == 0) return kInfinity;
    z = map.base + map.axis[0] * raw[0] + map.axis[1] * raw[1] + map.axis[2] * raw[2];
  } else {
    if (!(raw[0] > map.sky_below && raw[0] < map.sky_above)) return kInfinity;
    const double value = map.slope * (raw[0] - map.origin);
    switch (map.form) {
      case kDepthReciprocal: z = 1 / (map.base + value); break;
      case kDepthExponential: z = map.base * std::expm1(value); break;
      default: z = map.base + value;
    }
  }
  if (!(z > 0 && z < map.sky_depth)) return kInfinity;
  return map.along_ray ? z / ray_length : z;
}

double raw_of(const DepthMap& map, double planar, double ray_length) {
  const double z = map.along_ray ? planar * ray_length : planar;
  switch (map.form) {
    case kDepthReciprocal: return map.origin + (1 / z - map.base) / map.slope;
    case kDepthExponential: return map.origin + std::log1p(z / map.base) / map.slope;
    default: return map.origin + (z - map.base) / map.slope;
  }
}

bool is_all_sky(const DepthMap& map, std::span<const float> raw) {
  if (map.form == kDepthPosition) return std::ranges::all_of(raw, [](float x) { return x == 0; });
  const auto below = float(map.sky_below);
  const auto above = float(map.sky_above);
  return std::ranges::all_of(raw, [&](float x) { return x >= above || x == below; });
}

double step_of(std::span<const float> raw) {
  constexpr std::size_t kSampled = 4096;
  constexpr std::size_t kLeastOnLevels = 64;  // fewer may lie on the levels of integers by chance
  constexpr double kExact = 0.02;             // of a step: how near to a level a float is that can tell
  const std::size_t sparse = raw.size() / kSampled + 1;
  for (const int bits : {16, 24}) {
    const double levels = std::exp2(bits) - 1;
    std::size_t values = 0;
    bool is_on_levels = true;
    for (std::size_t i = 0; i < raw.size() && is_on_levels; i += sparse) {
      const double level = raw[i] * levels;
      if (!(raw[i] > 0 && raw[i] < 1) || level * kFloatPrecision > 0.5 * kExact) continue;
      is_on_levels = std::abs(level - std::round(level)) < kExact;
      values++;
    }
    if (is_on_levels && values >= kLeastOnLevels) return 1 / levels;
  }
  return 0;
}

DepthPrecision depth_precision(const DepthMap& map, double raw_precision, double step) {
  constexpr double kRenderers = 0x1p-16;  // measured: up to 8e-6; with room for what bounds of tiles lose
  // A position's coordinates, each known to a part of itself, and their products are added up.
  const double from_origin = map.form == kDepthPosition ? 2 * map.eye_distance : 0;
  const double slope = std::abs(map.slope);
  const double rest =
      raw_precision * std::max(from_origin, std::abs(map.slope * map.origin - map.base)) + 0.5 * step * slope;
  DepthPrecision precision;
  precision.at[1] = std::max(kRenderers, raw_precision);
  switch (map.form) {
    case kDepthReciprocal: precision.at[2] = rest; break;
    case kDepthExponential:
      precision.at[0] = (raw_precision + 0.5 * step) * map.base * slope;
      precision.at[1] = std::max(kRenderers, (raw_precision + 0.5 * step) * slope);
      break;
    default: precision.at[0] = rest;
  }
  return precision;
}

bool list_all(std::span<const BehindPlane> planes) {
  return std::ranges::all_of(
      planes, [](const BehindPlane& plane) { return plane.kind == BehindKind::surfaces && plane.is_whole; });
}

bool dims_beauty(const std::vector<AmbientReading>& lights) {
  return std::ranges::none_of(lights, [](const AmbientReading& light) { return light.weight.has_value(); });
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

DepthPrecision depth_precision_of(const Reading& reading) {
  const double of_type = reading.depth_is_half ? kHalfPrecision : kFloatPrecision;
  return depth_precision(depth_map_of(reading), std::max(of_type, reading.depth_rounding), reading.depth_step);
}

}  // namespace alcove
