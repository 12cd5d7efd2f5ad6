// What a depth channel's values mean: one map from any kind of depth to planar depth, the same on the host and in
// prepare.comp.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera.h"

namespace alcove {

/// Raw value -> planar depth in scene units. The forms are those of kernels/geometry.h.
struct DepthMap {
  uint form = 0;
  bool along_ray = false;  // the form gives the distance to the eye
  double origin = 0, base = 0, slope = 1;
  double sky_below = 0, sky_above = std::numeric_limits<double>::infinity();  // raw depth at or beyond them is sky
  double sky_depth = 1e9;                                                     // scene units
  std::array<double, 3> axis{};                                               // of positions
  // of positions: from their origin to the eye, scene units
  double eye_distance = 0;
};

/// How far a planar depth z may be from the surface's: at[0] + at[1] z + at[2] z^2, scene units.
struct DepthPrecision {
  std::array<double, 3> at{};

  double at_depth(double z) const { return at[0] + z * (at[1] + z * at[2]); }
};

/// With d the value and n, f the planes:
/// planar z = d; ray: |position| = d; inverse z = 1/d; normalized z = n + d (f - n); log z = ((1 + C f)^d - 1) / C;
/// device 1/z = 1/n - d (1/n - 1/f), of an orthographic camera z = n + d (f - n); position z = -(view z). `reversed`
/// puts 1 - d for d, a device range of -1 to 1 (d + 1) / 2. Of device, normalized and log depth only what is strictly
/// between 0 and 1 is a surface, but for normalized depth that goes on beyond its planes. Fails with
/// ErrorKind::usage where the kind needs a plane, a world matrix or a perspective that is not there.
DepthMap depth_map(DepthKind kind, const DepthRange& range, PositionSpace space, const Camera& camera, double scale,
                   double sky);

/// The options of a range that depth of this kind has not.
std::vector<std::string> unused_range_options(const DepthRange& said, DepthKind kind);
/// Fails with ErrorKind::usage, since these options have no effect on the depth of that name.
[[noreturn]] void refuse_range_options(const std::string& depth, std::span<const std::string> options, DepthKind kind);

/// Whether every raw value plainly says that there is no surface: none is one, or has to be repaired to be none. Of
/// positions: x, y and z are 0.
bool is_all_sky(const DepthMap& map, std::span<const float> raw);

/// Planar depth of a raw value, or of a position; infinite for sky. `ray_length`: the length of the pixel's ray at unit
/// depth.
double planar_depth(const DepthMap& map, const std::array<double, 3>& raw, double ray_length);

/// Half a step of floats, and of half floats, as a part of the raw value.
constexpr double kFloatPrecision = 0x1p-24, kHalfPrecision = 0x1p-11;

/// The step of device, normalized or log depth that was rounded to 16 or 24 bits; 0: it was not rounded. Only small
/// values show a step of 24 bits, and only there it matters: larger floats are as coarse themselves.
double step_of(std::span<const float> raw);

/// Whether there are enough values to tell whether they were rounded to 16 bits.
bool shows_step(std::span<const float> raw);

/// The precision of the planar depth from raw values that are known to this part of themselves, and rounded to
/// multiples of `step`. It is never less than 2^-16 of the depth, twice what renderers' own arithmetic loses where
/// surfaces 1000 units across are seen from a few units away (measured: 8e-6).
DepthPrecision depth_precision(const DepthMap& map, double raw_precision, double step = 0);

/// The word for a kind on the command line.
const char* name_of(DepthKind kind);

}  // namespace alcove
