// What stands clear of a receiver's tangent plane: one rule for every estimator.
// Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Depth is known to a limited precision only, and normals are rounded: on a plane each pixel would see some of its
// neighbours rise a little. So a sample blocks only if its height exceeds what the errors of two depths can feign plus
// kLeastRise pixels for every pixel that it lies aside. It must also stand kLeastElevation above the plane,
// which counts where the surface is seen aslant. What stands lower than an angle takes at most the squared sine of that
// angle from the visibility: once the errors of two depths are small beside a pixel, that is the square of kLeastRise,
// 1.6e-5.

const float kLeastRise = 4e-3;
const float kLeastElevation = 1e-3;  // sine

/// Whether what stands so high above the tangent plane, at a distance whose square is given, stands above an elevation.
/// per_elevation: one over its sine. The square of a small height would underflow where units are large.
bool is_elevated(float height, float per_elevation, float distance_sq) {
  const float height_by_sine = height * per_elevation;
  return height_by_sine * height_by_sine > distance_sq;
}

/// What goes on beyond the border counts where it stands so high above the tangent plane, in radii: a floor that the
/// border cuts stays open, whatever its normal map.
const float kLeastRisen = 0.1;

/// The height above a tangent plane that the errors of two depths near z can feign. depth_height: how much height a
/// unit of depth is.
float least_height(vec3 depth_precision, float z, float depth_height) {
  return 2.0 * abs(depth_height) * (depth_precision.x + z * (depth_precision.y + z * depth_precision.z));
}

/// Height for every pixel aside, at unit depth (orthographic: at any).
float least_rise(View view) { return kLeastRise * view.tangent_per_pixel.x; }
