// Pixel <-> view space, for perspective and orthographic projections. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

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

/// Steps of `direction` that stay on the image, from `pixel`.
float steps_to_border(View view, ivec2 pixel, vec2 direction) {
  const vec2 room = mix(vec2(pixel), vec2(view.size - 1 - pixel), greaterThan(direction, vec2(0)));
  const vec2 steps = room / max(abs(direction), 1e-6);
  return min(steps.x, steps.y);
}
