// Straight pieces of the profile of a line, and what of them and of the solids behind them lies within the sphere of
// the radius. Pure: no bindings; to be included after slice.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// Places are (across, toward): across the receiver's eye ray in the plane of the line, and towards the eye.

const float kNone = 1e30;

/// A ray that misses the sphere by less than this part of its squared radius touches it.
const float kTouches = 1e-3;

/// A piece of the profile.
struct Stroke {
  vec2 from, to;
};

/// The part of a stroke within the sphere of the radius.
struct Clipped {
  vec2 near, far;
  bool is_within;  // whether it holds anything
};

/// The direction of the eye's ray through a place.
vec2 away_from_eye(vec2 place, float eye_distance) {
  const vec2 ray = mix(vec2(0, -1), place - vec2(0, eye_distance), bvec2(eye_distance < kNone));
  return ray * inversesqrt(dot(ray, ray));
}

/// slope_of() the back of an occluder that is endless: where the eye's ray through its front leaves the sphere.
float back_of(vec2 front, float eye_distance, float radius_sq) {
  const vec2 direction = away_from_eye(front, eye_distance);
  const float middle = dot(front, direction);
  const float leaves = sqrt(max(0.0, middle * middle - dot(front, front) + radius_sq)) - middle;
  return slope_of(front + leaves * direction);
}

/// slope_of() where the eye's ray through a front enters what of a solid lies within the sphere, and where it leaves
/// that; (-1, 1): nothing of it lies there. The solid is `thickness` deep. back: its end.
vec2 depths_of(vec2 front, float eye_distance, float thickness, float radius_sq, out vec2 back) {
  const vec2 direction = away_from_eye(front, eye_distance);
  const float middle = dot(front, direction);
  const float outside_sq = dot(front, front) - radius_sq;
  const float inside_sq = middle * middle - outside_sq;
  const float inside = sqrt(max(0.0, inside_sq));
  const float enters = mix(0.0, -inside - middle, outside_sq > 0.0);
  const float leaves = min(thickness, inside - middle);
  back = front + thickness * direction;
  const bool exists =
      both(both(front.x > 0.0, inside_sq > -kTouches * radius_sq), both(enters >= 0.0, enters <= leaves));
  return exists ? vec2(slope_of(front + enters * direction), slope_of(front + leaves * direction)) : vec2(-1, 1);
}

/// The part of a stroke within the sphere of the radius about the receiver: with from + t (to - from), the t between
/// the roots of |from + t (to - from)|^2 = radius^2. They hold products of four lengths, which overflow where the
/// scene's numbers are large. So `along` is divided by a power of two near the receiver's depth, and t is multiplied by
/// it, which changes no bit.
Clipped clip_to_sphere(Stroke stroke, float radius_sq, float unit) {
  const vec2 from = stroke.from, along = (1.0 / unit) * (stroke.to - stroke.from);
  const float a = dot(along, along);
  const float middle = dot(from, along);
  const float beside = from.x * along.y - from.y * along.x;
  const float inside_sq = a * radius_sq - beside * beside;
  const float inside = sqrt(max(inside_sq, 0.0));
  const float scale = 1.0 / a;
  const float enters = max((-middle - inside) * scale, 0.0);
  const float leaves = min((inside - middle) * scale, unit);
  return Clipped(from + enters * along, from + leaves * along, both(inside_sq > 0.0, enters <= leaves));
}

/// A stroke goes on to the receiver's own ray at most: to this part of its distance across the ray.
const float kBesideReceiver = 1e-3;

/// The stroke with what its surface goes on behind others: towards the receiver from the first vertex of a run, else
/// away from it.
Stroke with_unseen(Stroke stroke, bool begins, vec2 unseen) {
  const float across = stroke.to.x;
  const float least = kBesideReceiver * across;
  const float part = unseen.x < least ? (across - least) / (across - unseen.x) : 1.0;
  const vec2 toward = stroke.to + part * (unseen - stroke.to);
  return begins ? Stroke(toward, stroke.to) : Stroke(stroke.from, unseen);
}
