// A slice through the view ray on the image: its two sides, and how high a sample stands in it. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// In a slice an angle theta is measured from the direction V to the eye; here it goes by its cotangent, which falls
// from infinity at V. Coordinates in a slice are (across V, towards the eye) from the receiver. They are linear in the
// sample's depth and in its offset on the image, so no sample needs a vector in space. A sample lies at the centre of a
// pixel, up to half a pixel beside the slice. It is moved into the slice parallel to the receiver's tangent plane,
// which keeps its height above it: a flat surface stays flat at every tilt, whatever pixel a step snaps to. Where that
// plane is so steep across the slice that the sample would move by more than it lies beside it, it moves only so far.

// How the weight of a hit fades towards the radius.
const uint kFalloffNone = 0;       // whatever is nearer than the radius blocks
const uint kFalloffLinear = 1;     // from 1 at the start to 0 at the radius
const uint kFalloffQuadratic = 2;  // 1 - x^2
const uint kFalloffSmooth = 3;     // 1 - smoothstep

/// The weight of a hit at this distance, 0 to 1.
float falloff_weight(uint falloff, float distance_to_hit, float start, float radius) {
  const float x = clamp((distance_to_hit - start) / (radius - start), 0.0, 1.0);
  if (falloff == kFalloffLinear) return 1.0 - x;
  if (falloff == kFalloffQuadratic) return 1.0 - x * x;
  if (falloff == kFalloffSmooth) return 1.0 - x * x * (3.0 - 2.0 * x);
  return 1.0;
}

// Slices to whose plane the normal is nearly perpendicular weigh less than this, and are left out.
const float kLeastWeight = 1e-4;

/// Sine of the normal's tilt from the eye's ray below which its direction is not made a unit vector. Normals are stored
/// within 4e-5 rad, so there it is mostly rounding; and what depends on it, the pull, differs from 1 by less than the
/// square of this.
const float kLeastTilt = 1e-3;

/// Steps grow with the square of the distance, so that near occluders are not missed. More steps than this are enough
/// to sample all of the reach densely instead: the exponent is then the one with which the first step is a pixel long.
const int kManySteps = 16;

/// The parameters that an estimator's loop over samples needs. They are read once, since lavapipe gathers a
/// parameter anew at each use within a loop.
struct Reach {
  float radius, radius_sq, falloff_start;  // scene units
  float front_sq;                          // of the farthest front that may block, squared
  float thickness;                         // scene units, infinite allowed; 0: as deep as wide
  float per_elevation;  // one over the sine of the elevation above the tangent plane below which nothing blocks
  float least_rise;     // of a sample: see clearance.glsl
  float pixel_size;     // scene units at unit depth (orthographic: at any)
  int width;            // of the image, px
};

struct Receiver {
  ivec2 pixel;
  float z;           // planar depth
  vec3 normal, eye;  // unit, view space; towards the eye
  // of a point above the tangent plane: scale * dot(height, offset in pixels) + (z - receiver's z) * depth_height
  vec2 height;
  float depth_height;
  float least_height;  // of a sample: see clearance.glsl
  vec2 tangent_per_pixel;
  float eye_distance;  // scene units
  float ray_length;    // of the eye's ray at unit depth
  vec2 tangent;        // of the pixel
  bool perspective;
  // the sphere of the radius is seen under this angle; 1 and more: it holds the eye, and the image is the only limit
  float sin_reach;
};

/// A plane through V and a unit vector T across it.
struct Slice {
  vec3 t;
  float share;                 // of the azimuths: one over the density with which such slices are drawn
  float weight;                // length of the normal's projection
  float cos_gamma, sin_gamma;  // gamma: the projected normal's angle, from V towards T
  float gamma;
  vec2 image_t;         // the image of T: pixels per unit of length at unit depth
  vec2 across, toward;  // of the side towards T
};

/// One half of a slice.
struct Side {
  vec2 direction_px;  // pixels per step; the longer component is +-1
  float reach;        // steps within the radius and the image
  float whole_reach;  // steps within the radius, on the image or not; kEndless: any number
  // coordinates in the slice: scale * dot(across, offset), ray_length * (receiver's z - z) + scale * dot(toward,
  // offset)
  vec2 across, toward;
  float plane_cot;  // cotangent of the tangent plane
  vec2 ahead;       // a place on the tangent plane
  vec3 t;           // unit, view space: T of this side
  float gamma, cos_gamma, sin_gamma;
};

/// Two unit vectors that with v (v.z > 0) form a right-handed basis, smooth over the image (Duff et al., "Building an
/// Orthonormal Basis, Revisited", 2017).
void basis_of(vec3 v, out vec3 x, out vec3 y) {
  const float a = 1.0 / (1.0 + v.z), b = -v.x * v.y * a;
  x = vec3(1.0 - v.x * v.x * a, b, -v.x);
  y = vec3(b, 1.0 - v.y * v.y * a, -v.y);
}

Receiver receiver_at(View view, ivec2 pixel, float z, vec3 normal, float radius, vec3 depth_precision) {
  Receiver r;
  r.pixel = pixel;
  r.z = z;
  r.normal = normal;
  r.perspective = view.orthographic == 0;
  r.tangent = tangent_of(view, vec2(pixel) + 0.5);
  r.ray_length = r.perspective ? sqrt(1.0 + dot(r.tangent, r.tangent)) : 1.0;
  r.eye = r.perspective ? vec3(-r.tangent, 1.0) / r.ray_length : vec3(0, 0, 1);
  r.eye_distance = z * r.ray_length;
  r.tangent_per_pixel = view.tangent_per_pixel;
  r.height = normal.xy * view.tangent_per_pixel;
  r.depth_height = (r.perspective ? dot(normal.xy, r.tangent) : 0.0) - normal.z;
  r.least_height = least_height(depth_precision, z, r.depth_height);
  r.sin_reach = r.perspective ? radius / r.eye_distance : 0.0;
  return r;
}

/// The slice through a unit vector orthogonal to V, in the terms of the paper that horizon.comp names: `t` is that
/// (line 9), `weight`, cos_gamma and sin_gamma are the length and the direction of its projected normal (lines 11 to
/// 15).
Slice slice_along(View view, Receiver r, vec3 t, float share) {
  Slice s;
  s.t = t;
  s.share = share;
  const float n_t = dot(r.normal, s.t), n_v = dot(r.normal, r.eye);
  s.weight = sqrt(n_t * n_t + n_v * n_v);
  s.cos_gamma = n_v / s.weight;
  s.sin_gamma = n_t / s.weight;
  s.gamma = angle_of(s.cos_gamma, s.sin_gamma);
  const vec3 b = cross(s.t, r.eye);
  const float turn = dot(r.normal, b) / s.weight;
  const vec2 beside = turn / (s.weight * max(1.0, abs(turn))) * b.xy * view.tangent_per_pixel;
  s.across = s.t.xy * view.tangent_per_pixel + n_t * beside;
  s.toward = r.eye.xy * view.tangent_per_pixel + n_v * beside;
  s.image_t = (r.perspective ? s.t.xy + r.tangent * s.t.z : s.t.xy) / view.tangent_per_pixel;
  return s;
}

/// The slice of an azimuth. Slices near the normal hold most of the cosine-weighted hemisphere where it is seen aslant:
/// up to tan of its tilt times as much as those across. A lone slice is drawn that much more often there, by pulling
/// its azimuth towards the normal as an ellipse does, and weighs the less: the ratio of blocked to whole would else be
/// biased. The more slices per pixel has, the less this matters, and the less they are pulled.
Slice slice_at(View view, Receiver r, uint index, uint slices, float jitter) {
  const float azimuth = kPi * (float(index) + jitter) / float(slices);
  vec3 x, y;
  basis_of(r.eye, x, y);
  const float cos_tilt = dot(r.normal, r.eye);
  const float sin_tilt = sqrt(max(0.0, 1.0 - cos_tilt * cos_tilt));
  const vec2 on_image = direction_of(azimuth);
  const vec3 even = on_image.x * x + on_image.y * y;
  const vec3 across = (r.normal - cos_tilt * r.eye) / max(sin_tilt, kLeastTilt);
  const float pull =
      mix(1.0, sqrt(cos_tilt / (cos_tilt + angle_of(cos_tilt, sin_tilt) * sin_tilt)), 1.0 / float(slices * slices));
  const vec3 t = normalize(pull * even + (1.0 - pull) * dot(even, across) * across);
  const float along = dot(t, across);
  return slice_along(view, r, t, (1.0 - (1.0 - pull * pull) * along * along) / pull);
}

/// More steps than any image has.
const float kEndless = 1e9;

/// Steps of a side that lie within the sphere of the radius, on the image or not; kEndless: any number. pixels: of the
/// side's image T, per unit of length at unit depth. eye_z, t_z: z of the direction to the eye and of T on that side.
/// sin_reach: the sphere is seen under the angle of this sine. The ray that touches it leaves the image of the sphere
/// at sin_reach * pixels / (eye_z cos_reach - t_z sin_reach) pixels from the receiver's.
float steps_in_sphere(View view, float pixels, float eye_z, float t_z, float sin_reach, float radius) {
  const float cos_reach = sqrt(max(0.0, 1.0 - sin_reach * sin_reach));
  const float forward = eye_z * cos_reach - t_z * sin_reach;
  const float steps = view.orthographic == 0 ? sin_reach * pixels / forward : radius * pixels;
  return sin_reach < 1.0 && forward > 0.0 ? steps : kEndless;
}

/// The side of a slice towards sign * T.
Side side_of(View view, Receiver r, Slice s, float sign, Reach reach) {
  const float pixels = max(abs(s.image_t.x), abs(s.image_t.y));
  Side side;
  side.gamma = sign * s.gamma;
  side.cos_gamma = s.cos_gamma;
  side.sin_gamma = sign * s.sin_gamma;
  side.direction_px = sign / pixels * s.image_t;
  side.across = sign * s.across;
  side.toward = s.toward;
  side.plane_cot = -side.sin_gamma / s.cos_gamma;
  side.ahead = vec2(side.cos_gamma, -side.sin_gamma);
  side.t = sign * s.t;
  side.whole_reach = steps_in_sphere(view, pixels, r.eye.z, sign * s.t.z, r.sin_reach, reach.radius);
  side.reach = min(steps_to_border(view, r.pixel, side.direction_px), side.whole_reach);
  return side;
}

/// `a && b` without a branch: `&&` and `||` would jump.
bool both(bool a, bool b) { return a ? b : false; }

/// The offset in space from the receiver to a sample of depth z, `offset` pixels away. scale: z, or 1 orthographic.
vec3 offset_to(Receiver r, vec2 offset, float z, float scale) {
  return vec3((r.perspective ? z - r.z : 0.0) * r.tangent + scale * r.tangent_per_pixel * offset, r.z - z);
}

/// The place of that sample in the slice.
vec2 place_of(Receiver r, Side side, vec2 offset, float z, float scale) {
  return vec2(scale * dot(side.across, offset), r.ray_length * (r.z - z) + scale * dot(side.toward, offset));
}

/// The height of that sample above the tangent plane.
float height_of(Receiver r, vec2 offset, float z, float scale) {
  return scale * dot(r.height, offset) + (z - r.z) * r.depth_height;
}

/// Whether that sample stands clear of the tangent plane, and before the eye's ray. distance_sq: from the receiver.
/// steps: from the receiver to the sample.
bool is_above(Receiver r, Reach reach, vec2 place, float distance_sq, float steps, vec2 offset, float z, float scale) {
  const float height = height_of(r, offset, z, scale);
  const bool clear = height > r.least_height + scale * (reach.least_rise * steps);
  return both(place.x > 0.0, both(clear, is_elevated(height, reach.per_elevation, distance_sq)));
}

/// Stands for an angle: a number that is cheaper than its cotangent and falls as that does, from 1 at V to -1.
float slope_of(vec2 place) { return place.y / (place.x + abs(place.y)); }

/// A place at the angle that a slope stands for.
vec2 place_at(float slope) { return vec2(1.0 - abs(slope), slope); }

Reach reach_of(View view, float radius, float falloff_start, float front, float thickness, float bias) {
  const float least = max(bias, kLeastElevation);
  return Reach(radius, radius * radius, falloff_start, front * front, thickness, 1.0 / least, least_rise(view),
               view.tangent_per_pixel.x, view.size.x);
}

/// The exponent with which the distance grows with the sample's number.
float step_exponent(int steps, float reach) {
  return mix(2.0, clamp(log2(max(reach, 1.0)) / log2(float(steps)), 1.0, 2.0), steps > kManySteps);
}

/// Steps from the receiver to sample k of `steps`, of which `count` are pixels apart; never two samples in one pixel:
/// short reaches are searched pixel by pixel.
float step_offset(int k, int steps, int count, float reach, float jitter) {
  const float x = (float(k) + jitter) / float(steps);
  return count < steps ? float(k + 1)
                       : max(float(k + 1), mix(x * x, pow(x, step_exponent(steps, reach)), steps > kManySteps) * reach);
}

/// Whether two samples `gap` steps apart are taken for one surface.
bool same_surface(Receiver r, Reach reach, float z, float last_z, float gap) {
  return abs(z - last_z) < kRunSlope * reach.pixel_size * gap * mix(1.0, lesser(z, last_z), r.perspective);
}

/// Of the tolerance for two samples the part, beside that of a pixel, that the pixel in their middle has to each: more
/// than half, since slopes change.
const float kHalfGap = 0.53;

/// Whether two samples of depths z and last_z are one surface by the depth of the pixel in their middle, too. Else two
/// wires before a wall would be one thing, as wide as they are apart.
bool is_through(Receiver r, Reach reach, float z, float middle_z, float last_z, float gap) {
  const float tolerance = mix(1.0, gap, kHalfGap);
  return both(same_surface(r, reach, z, middle_z, tolerance), same_surface(r, reach, middle_z, last_z, tolerance));
}

/// The arc integral of a whole side, down to the tangent plane: (cos(n) + 2 h sin(n) - cos(2 h - n)) / 4 of Jimenez et
/// al., 2016 (equation 7, one side of it), at h = n + pi/2, where n is gamma.
float whole_arc(Side side) { return 0.5 * (side.cos_gamma + (side.gamma + kHalfPi) * side.sin_gamma); }

/// The same integral from the view ray to the angle h of a place. With c = cos(h) and s = sin(h), cos(2 h - n) is
/// cos(n) - 2 s (s cos(n) - c sin(n)), so that no angle but h itself is needed.
float arc_to(Side side, vec2 place) {
  return 0.5 * (place.x * (place.x * side.cos_gamma - place.y * side.sin_gamma) / dot(place, place) +
                angle_of(place.y, place.x) * side.sin_gamma);
}

/// The direction of the eye's own ray at a place.
vec2 away_from_eye(Receiver r, vec2 place) {
  const vec2 ray = place - vec2(0, r.eye_distance);
  return mix(vec2(0, -1), ray * inversesqrt(dot(ray, ray)), bvec2(r.perspective));
}

/// The back of an occluder whose front is at `front`: `thickness` further along the eye's own ray, but not beyond the
/// sphere of the radius.
vec2 back_of(Receiver r, vec2 front, float thickness, float radius) {
  const vec2 away = away_from_eye(r, front);
  const float along = dot(front, away);
  const float exit = sqrt(max(0.0, along * along - dot(front, front) + radius * radius)) - along;
  return front + min(thickness, exit) * away;
}

/// A run reaches on average so far into the gaps to the samples before and behind it: up to their middles at most.
const float kGapPart = 1.0 / 3.0;

/// The thickness of a run by its width: a long one levels off, a wall is not as thick as it is long. most: the width
/// from which it grows no more.
float levelled(float width, float most) {
  const float part = lesser(width / most, 1.0);  // a length's third power would overflow
  return most * part * (1.0 - part * part / 3.0);
}

/// Whether a place lies outside of the sphere of the radius, and the eye's ray comes nearer to the receiver behind it.
bool is_before_sphere(Receiver r, Reach reach, vec2 place) {
  const float distance_sq = dot(place, place);
  return both(distance_sq > reach.radius_sq, r.perspective ? distance_sq < place.y * r.eye_distance : place.y > 0.0);
}

/// slope_of() where the eye's ray through a front enters what of a solid lies within the sphere of the radius, and
/// where it leaves that; (-1, 1): nothing of it lies there. The solid is `thickness` deep.
vec2 depths_of(Receiver r, vec2 front, float thickness, float radius_sq) {
  const vec2 away = away_from_eye(r, front);
  const float middle = -dot(front, away);
  const float outside_sq = dot(front, front) - radius_sq;
  const float inside_sq = middle * middle - outside_sq, inside = sqrt(max(0.0, inside_sq));
  const float enters = outside_sq > 0.0 ? middle - inside : 0.0;
  const float leaves = min(thickness, middle + inside);
  const bool exists = both(inside_sq > 0.0, both(enters >= 0.0, enters <= leaves));
  return exists ? vec2(slope_of(front + enters * away), slope_of(front + leaves * away)) : vec2(-1, 1);
}
