// Distant surroundings as nine colours, for surfaces with nine coefficients of openness.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/base/image.h"

namespace alcove {

/// The light of a sky in the real spherical harmonics of l <= 2, in the order of the AOV `transfer`.
struct Environment {
  std::array<std::array<double, 3>, 9> light{};  // of red, green and blue
  /// The share of the light, 0 to 1, that comes from elsewhere than the nine colours say: half the integral of the
  /// difference over that of the light.
  double missed = 0;
  bool operator==(const Environment&) const = default;
};

/// Nine colours hold a sky whose `missed` is at most this: that of gradients is .03 to .1, with a sun .3 and more.
inline constexpr double kMostMissed = 0.15;

/// Reads a lat-long picture. Its upper edge is up, z, and its middle x, as in Blender: u = .5 - atan2(y, x) / 2 pi,
/// v = .5 - asin(z) / pi from the top. Fails with ErrorKind::input where it isn't twice as wide as high, holds NaN,
/// infinity or values below 0, has no R, G and B, or is no EXR and no Radiance HDR.
Environment read_environment(const std::string& path, const char* option);

/// The same of planes R, G and B, one behind the other.
Environment environment_of(std::span<const float> planes, int width, int height);

/// Whether a file is a lat-long picture of colours alone.
bool is_sky_picture(const std::string& path);

/// The colours, the share that they miss, and a Nuke node that uses them: lines for people; and as JSON.
std::string environment_text(const std::string& path, const Environment& environment);
std::string environment_json(const std::string& path, const Environment& environment);

}  // namespace alcove
