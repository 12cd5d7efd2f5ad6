// Pixel <-> view space, for perspective and orthographic projections. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

/// The largest power of two that is not above a depth. Lengths that are divided by it keep their bits, and products of
/// several neither overflow nor underflow, whatever the scene's units.
float power_of_two(float z) { return uintBitsToFloat(floatBitsToUint(clamp(z, 1e-30, 1e30)) & 0x7f800000u); }

/// The point where the ray of an image point meets the plane at unit depth (perspective), or its place in the plane
/// (orthographic).
vec2 tangent_of(View view, vec2 point_px) { return (point_px - view.center) * view.tangent_per_pixel; }

/// The view-space position of an image point at planar depth z (> 0, scene units).
vec3 position_of(View view, vec2 point_px, float z) {
  const vec2 t = tangent_of(view, point_px);
  return vec3(view.orthographic != 0 ? t : t * z, -z);
}

/// The pixel in which a view-space position before the eye is seen. It is counted from the centre outwards, so that it
/// is the same one in a part of the image.
ivec2 pixel_of(View view, vec3 position) {
  const vec2 whole = floor(view.center);
  const vec2 from_center =
      position.xy / (view.orthographic != 0 ? vec2(1) : vec2(-position.z)) / view.tangent_per_pixel;
  return ivec2(whole) + ivec2(floor(clamp(from_center + (view.center - whole), -1e6, 1e6)));
}

/// The unit vector from a position towards the eye.
vec3 toward_eye(View view, vec3 position) { return view.orthographic != 0 ? vec3(0, 0, 1) : normalize(-position); }

/// The distance of a pixel's surface from the eye (perspective), or from the eye's plane.
float eye_distance(View view, ivec2 pixel, float z) {
  const vec2 t = tangent_of(view, vec2(pixel) + 0.5);
  return view.orthographic != 0 ? z : z * sqrt(1.0 + dot(t, t));
}

bool inside(View view, ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, view.size));
}

int index_of(View view, ivec2 pixel) { return pixel.y * view.size.x + pixel.x; }

/// The width of a pixel at planar depth z, scene units.
float pixel_width(View view, float z) { return view.tangent_per_pixel.x * (view.orthographic != 0 ? 1.0 : z); }

/// What is added to a number of pixels that would be whole but for rounding, so that every device counts as many.
const float kWholePixels = 0.01;

/// Steps of `direction` that stay on the image, from `pixel`, and kWholePixels.
float steps_to_border(View view, ivec2 pixel, vec2 direction) {
  const vec2 room = mix(vec2(pixel), vec2(view.size - 1 - pixel), greaterThan(direction, vec2(0)));
  const vec2 steps = (room + kWholePixels) / max(abs(direction), 1e-6);
  return min(steps.x, steps.y);
}

/// A surface goes on where no pixel shows it no nearer to the eye and no farther from it than so many times its depth.
const float kMostChange = 2.0;

/// Neighbours on a line whose depths differ by less than this many pixels' worth of slope, for every step between them,
/// are one surface.
const float kRunSlope = 8.0;

/// The sine of the angle below a border pixel's tangent plane from which on what is seen is another surface: a smooth
/// one bends less, and a normal map leans less.
const float kMostBend = 0.55;

/// A plane seen more nearly edge on than this says nothing of where its surface goes on: the dot product of the unit
/// normal and the vector to the eye. pieces.glsl takes that vector 1 long; others take it with depth 1. A normal that
/// leaned away from the eye has been bent to 0.001.
const float kLeastFacingToGoOn = 0.02;

/// Places less than this part of the depth apart are one.
const float kRounding = 1e-6;

/// The depth at which the plane of a border pixel's surface goes on at an image point beyond the border; kSkyDepth: it
/// does not. It goes on no farther than it is seen inside: where the pixel as far inside, the mirrored one, shows
/// something behind the plane, the surface has ended. from, mirrored, to: tangent_of() the centres of the two pixels
/// and the point. z, n: depth and unit normal of the border's pixel; mirrored_z: depth of the mirrored one.
/// least_facing: of the plane at the pixel and at the point; the dot product of the normal and the way to the eye,
/// which is 1 long along the optical axis.
float depth_beyond(View view, vec2 from, float z, vec3 n, vec2 mirrored, float mirrored_z, vec2 to,
                   float least_facing) {
  const bool perspective = view.orthographic == 0;
  const float facing_from = n.z - (perspective ? dot(n.xy, from) : 0.0);
  const float facing_to = n.z - (perspective ? dot(n.xy, to) : 0.0);
  const float there = perspective ? z * facing_from / facing_to : z + dot(n.xy, to - from) / facing_to;
  const bool faces = min(facing_from, facing_to) > least_facing;
  const vec3 inward = vec3(perspective ? mirrored_z * mirrored - z * from : mirrored - from, z - mirrored_z);
  // The mirrored pixel may be the border's own: then `inward` is nothing but rounding.
  const bool goes_on = mirrored_z < kSkyDepth && dot(n, inward) >= -kMostBend * length(inward) - kRounding * z;
  return z < kSkyDepth && faces && goes_on && there > z / kMostChange && there < z * kMostChange ? there : kSkyDepth;
}

// Depths as keys that grow while a nearer one is sought: 0 is none, so a cleared plane is empty. Floats above 0 are
// ordered as their bits. The maximum of keys does not depend on the order in which they come.
uint key_of(float z) { return floatBitsToUint(kSkyDepth) - floatBitsToUint(z); }
float depth_of(uint key) { return uintBitsToFloat(floatBitsToUint(kSkyDepth) - key); }
