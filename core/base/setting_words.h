// The words that settings are made of: what a depth, a normal or an estimator may be. No numbers, no code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace alcove {

// what a file of --behind holds: the depth of surfaces of which nothing more is known; of those seen from outside, as
// culled peels and other elements are; of those seen from inside, which close the solid before them; or how far the
// first surface's solid goes on along the depth
enum class BehindKind { surfaces, fronts, backs, thickness };
// what motion vectors point to: the place in the frame before, or in the next one
enum class MotionKind { automatic, previous, next };
enum class DepthKind { automatic, planar, ray, inverse, device, normalized, log, position };
// of device depth between the near and the far plane: Vulkan, Direct3D; OpenGL
enum class DeviceRange { zero_to_one, minus_one_to_one };
enum class NormalSpace { automatic, world, view };
enum class PositionSpace { automatic, world, view };
enum class NormalEncoding { automatic, signed_float, unorm, octahedral, spheremap };
enum class Falloff : std::uint32_t { none, linear, quadratic, smooth };
enum class Estimator { gtao, bitmask, hbao, crytek };
// how gtao looks along a slice: at so many steps; at all pixels, by their outlines; at each of them
enum class SliceSearch { steps, exact, every_pixel };
// what HBAO measures a horizon from: the plane across the view ray, or the surface
enum class Elevation { view, surface };
// how Crytek's samples fill the hemisphere: more near the receiver, or even in volume
enum class SampleKernel { clustered, uniform };
// how Crytek's hits fade with the difference of depth between receiver and hit
enum class RangeCheck { none, ratio, smoothstep };
enum class ThicknessKind { automatic, infinite, constant };
// where surfaces are taken to go on although the frame does not show it: nowhere; beyond the picture's border; there
// and behind what is nearer
enum class Completion { none, border, all };
// where pixels have an estimate of their own: evenly over the image; more where surfaces show few pixels
enum class Density { uniform, adaptive };
// pixels of the frame per pixel of the estimate, in x and in y
enum class Resolution { full = 1, half = 2, quarter = 4 };
enum class Denoise { none, bilateral, box };
enum class Noise { fixed, animated };  // whether frames share one pattern of sample noise
// how a renderer makes a pixel from samples around its centre; see core/chain/results/reduce.h
enum class PixelFilterKind { box, gaussian, blackman_harris };
enum class AoChannels { mono, rgb };
enum class OutputType { half_float, single_float };
enum class Missing { error, skip };  // what a frame without its input is

/// What device, normalized and log depth are counted between.
struct DepthRange {
  // distance of the planes, in the file's units, 0 < near < far; far may be infinite (device only)
  std::optional<double> near, far;
  bool reversed = false;  // the near plane has the largest value
  DeviceRange device = DeviceRange::zero_to_one;
  double log_constant = 1;  // C of z = ((1 + C far)^d - 1) / C, 1 / the file's units, > 0
  // planar, ray and inverse depth: the values are below 0; view positions: their z is not as the camera's
  bool negative = false;
  // normalized depth: the values were not cut off at the near plane, or at the far plane, and go on beyond it
  bool goes_before_near = false, goes_beyond_far = false;
};

/// Axes of the normals that point the other way.
struct NormalFlips {
  bool x = false, y = false, z = false;
};

/// Files of one option, each with a place of its own; "" where there is none.
constexpr std::size_t kMostBehind = 8;
using FileList = std::array<std::string, kMostBehind>;

/// Pixels, counted from the display window's upper left corner.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;
};

}  // namespace alcove
