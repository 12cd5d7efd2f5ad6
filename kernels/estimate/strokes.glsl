// Straight pieces of a profile as a receiver sees them in its slice: what the sphere of the radius holds of them, and
// where they end behind. Pure: no bindings; to be included after slice.glsl.
// SPDX-License-Identifier: BSD-3-Clause

const float kNone = 1e30;

/// A vertex that stands alone is the end of a stroke from this part of its distance on: so short that its depth within
/// the sphere and its slopes are those of the vertex within 0.1 %, and long enough not to be lost in rounding.
const float kShortStroke = 0.999;

/// A walk from vertex to vertex of one side.
struct Walk {
  vec2 last;        // the vertex before, in (across, toward)
  bool starts;      // there is none yet
  bool is_own;      // the run is the receiver's own surface
  float thickness;  // scene units, of the run; with several slots of the vertex before
  float change;     // of the thickness up to the next vertex; 0 with one slot
};

/// A piece of the profile, in (across, toward).
struct Stroke {
  vec2 from, to;
};

/// What the sphere of the radius holds of a stroke.
struct Clipped {
  vec2 near, far;
  bool is_within;  // whether it holds anything
  vec2 parts;      // of the stroke: where near and far are on it
};

/// slope_of() the back of an occluder: it lies `thickness` further along the eye's ray through its front (across,
/// toward), but not beyond the sphere.
float back_of(vec2 front, float eye_distance, float thickness, float radius_sq) {
  const vec2 ray = eye_distance < kNone ? front - vec2(0, eye_distance) : vec2(0, -1);
  const vec2 direction = ray * inversesqrt(dot(ray, ray));
  const float middle = dot(front, direction);
  const float leaves = sqrt(max(0.0, middle * middle - dot(front, front) + radius_sq)) - middle;
  const vec2 back = front + min(thickness, leaves) * direction;
  return slope_of(back);
}

/// The part of a stroke within the sphere of the radius about the receiver: with from + t (to - from), the t between
/// the roots of |from + t (to - from)|^2 = radius^2. They hold products of four lengths, which overflow where the
/// scene's numbers are large. So `along` is divided by a power of two near the receiver's depth, and t is multiplied by
/// it, which changes no bit.
Clipped clip_to_sphere(Stroke stroke, float radius_sq, float unit) {
  const float per_unit = 1.0 / unit;
  const vec2 from = stroke.from, along = per_unit * (stroke.to - stroke.from);
  const float a = dot(along, along);
  const float middle = dot(from, along);
  const float beside = from.x * along.y - from.y * along.x;
  const float inside_sq = a * radius_sq - beside * beside;
  const float inside = sqrt(max(inside_sq, 0.0));
  const float scale = 1.0 / a;
  const float enters = max(0.0, (-middle - inside) * scale);
  const float leaves = min(unit, (inside - middle) * scale);
  return Clipped(from + enters * along, from + leaves * along, both(inside_sq > 0.0, enters <= leaves),
                 per_unit * vec2(enters, leaves));
}

/// The largest power of two that is not above a depth.
float power_of_two(float z) { return uintBitsToFloat(floatBitsToUint(clamp(z, 1e-30, 1e30)) & 0x7f800000u); }

/// The stroke that ends at a vertex `steps` from the receiver. It begins at the vertex before. Nothing is seen before
/// the first vertex of a side, to which it begins at the pixel next to the receiver. A vertex that begins a run stands
/// alone, as a stroke that is short.
Stroke stroke_to(vec2 place, Walk walk, bool begins, int steps) {
  const float next_pixel = min(kShortStroke, 1.0 / float(steps));
  const vec2 onward = walk.starts ? next_pixel * place : walk.last;
  return Stroke(begins ? kShortStroke * place : onward, place);
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
