// What the CPU reference gives beside visibility, for tests alone.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/reference/reference.h"
#include "tests/support/scenes.h"

namespace alcove::test {

/// Gives the visibility that completed surfaces take from each pixel, in [0, 1]; 0 on sky and at pixels that were not
/// asked for. Thickness is the same with and without them.
std::vector<float> reference_completed(const HostFrame& frame, const ReferenceSettings& settings);

/// A light without size, in view space.
struct ReferenceLight {
  bool is_lamp = false;  // at a place; else a sun
  Vector at;             // scene units: that place; or a direction to the sun, 1 long
};

/// Gives 1 for each pixel that sees a light, and on sky and at pixels that were not asked for; else 0. Nothing blocks
/// farther away than `reach` (scene units); the settings' radius says how thick things may be.
std::vector<float> reference_shadow(const HostFrame& frame, const ReferenceSettings& settings,
                                    const ReferenceLight& light, double reach);

/// Gives (1 / pi) times the integral of the visibility, the cosine to the normal and the real spherical harmonics of
/// l <= 2 in view space as planes of (l, m) = (0, 0), (1, -1), (1, 0) ... (2, 2): constants are positive, and (1, 1)
/// goes by x. The first band is the mean open direction. 0 on sky and at pixels that were not asked for.
inline constexpr std::size_t kTransferPlanes = 9;
std::vector<float> reference_transfer(const HostFrame& frame, const ReferenceSettings& settings);

using Transfer = std::array<double, kTransferPlanes>;
/// These harmonics of a direction.
Transfer harmonics(Vec3 w);

/// Gives two planes: the parts, in [0, 1], of the hemispheres below and above each pixel's tangent plane that the
/// receiver's own surface blocks; 0 on sky and at other pixels than `pixels`. See pieces.glsl.
std::vector<float> reference_curvature(const HostFrame& frame, const ReferenceSettings& settings);

}  // namespace alcove::test
