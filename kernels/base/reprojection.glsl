// A surface that one view shows, as another view sees it. Pure: no bindings. After view.glsl, with reprojection.h.
// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces are one if they are no farther apart than so many times what a depth may be off.
const float kPrecisions = 4.0;

/// A depth to reckon with; sums with that of sky would overflow.
float finite_depth(float z) { return min(z, 1e18); }

float error_at(vec3 error, float z) { return error.x + z * (error.y + z * error.z); }

/// Two surfaces at planar depth z are two if they are farther apart than this, scene units. `given`: the user's
/// separation; below 0 there is none.
float separation_at(View view, vec3 depth_precision, float given, float z) {
  return given >= 0.0 ? given : kPrecisions * error_at(depth_precision, z) + pixel_width(view, z);
}
float separation_at(Reprojection r, float z) { return separation_at(r.to, r.depth_precision, r.separation, z); }

vec3 direction_there(Reprojection r, vec3 v) { return vec3(dot(r.row_x, v), dot(r.row_y, v), dot(r.row_z, v)); }
vec3 position_there(Reprojection r, vec3 p) { return direction_there(r, p) + r.offset; }

/// Planar depth at an image point of the plane through `position`.
float plane_depth(View view, vec2 point_px, vec3 position, vec3 normal) {
  const vec2 t = tangent_of(view, point_px);
  const float height = dot(normal, position);
  return view.orthographic != 0 ? (dot(normal.xy, t) - height) / normal.z : height / (dot(normal.xy, t) - normal.z);
}
