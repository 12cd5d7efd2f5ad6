// What goes on behind what interrupts it, and beyond the image's border, and the receiver's own surface, in a search
// that takes samples.
// SPDX-License-Identifier: BSD-3-Clause
//
// A surface that something nearer interrupts goes on in its plane. In a slice that is a straight piece from the
// surface's end; so all that it blocks is one more interval of angles. The plane is that of the normal at the end: with
// samples far apart it says better how a surface goes on than the line through two of them. A piece ends where it would
// be seen, and where it leaves the sphere of the radius.
//
// Beyond the image's border the surfaces that it cuts go on in their planes, as far as they are seen inside. There
// samples are taken, each of the plane of the border's nearest pixel.
//
// Only what stands above the receiver's tangent plane goes on behind something. There, a deeper point of a ray never
// stands higher above that plane than what is seen on the ray, measured by depth.
//
// The kernel has declared its buffers `occluder_depth` and `normal`, and how many steps a side takes, kSteps.

const float kNone = 1e30;

/// A squared distance beyond every sphere.
const float kBeyondSq = 3e38;

/// A straight piece of a surface in the slice.
struct Piece {
  vec2 near, far;
  bool exists;
};

/// The way from a place to the eye, of any length.
vec2 toward_eye(Receiver r, vec2 place) {
  return mix(vec2(0, 1), vec2(0, r.eye_distance) - place, bvec2(r.perspective));
}

/// A normal within the slice, as a unit vector; `word` is packed.
vec2 normal_in_slice(Receiver r, Side side, uint word) {
  const vec3 n = octahedral_direction(unpackSnorm2x16(word));
  const vec2 projected = vec2(dot(n, side.t), dot(n, r.eye));
  return projected * inversesqrt(max(dot(projected, projected), 1e-12));
}

/// Whether a normal within the slice, a unit vector, says how the surface at a place goes on.
bool is_told_by(vec2 surface_normal, Receiver r, vec2 place) {
  const vec2 eye = toward_eye(r, place);
  return dot(surface_normal, eye) > kLeastFacingToGoOn * length(eye);
}

/// The point of a surface's line that is seen behind a place, as the distance from `end` along the unit vector
/// `onward`; infinite where the place's ray never meets it.
float seen_at(Receiver r, vec2 end, vec2 onward, vec2 surface_normal, vec2 place) {
  const vec2 ray = toward_eye(r, place);
  const float facing = dot(surface_normal, ray);
  const vec2 meets = place - dot(surface_normal, place - end) / facing * ray;
  return facing > 0.0 ? max(dot(meets - end, onward), 0.0) : kNone;
}

/// The piece from `end` onward, as far as `most`, within the sphere of the radius and before the eye's ray.
Piece piece_of(Reach reach, vec2 end, vec2 onward, float most) {
  const float middle = dot(end, onward);
  const float inside_sq = middle * middle - dot(end, end) + reach.radius_sq;
  const float inside = sqrt(max(inside_sq, 0.0));
  const float to_ray = onward.x < 0.0 ? 0.999 * end.x / -onward.x : most;
  const float enters = max(0.0, -middle - inside), leaves = min(min(most, to_ray), inside - middle);
  return Piece(end + enters * onward, end + leaves * onward, both(inside_sq > 0.0, leaves > enters));
}

/// The largest and the smallest slope_of() a piece; none if it does not exist.
vec2 slopes_of(Piece piece) {
  const float near = slope_of(piece.near), far = slope_of(piece.far);
  return piece.exists ? vec2(max(near, far), min(near, far)) : vec2(-1, 1);
}

/// One sample of a side.
struct Sample {
  float offset;        // steps from the receiver
  float z, scale;      // planar depth; that, or 1 orthographic
  vec2 place;          // in the slice
  float slope;         // slope_of() it
  float distance_sq;   // from the receiver
  bool above, within;  // clear of the tangent plane; within the radius
};

/// The sample of a surface of depth z at a pixel `beside` the receiver's.
Sample sample_of(Receiver r, Side side, Reach reach, float offset, vec2 beside, float z) {
  Sample s;
  s.offset = offset;
  s.z = z;
  s.scale = r.perspective ? s.z : 1.0;
  s.place = place_of(r, side, beside, s.z, s.scale);
  s.slope = slope_of(s.place);
  s.distance_sq = dot(s.place, s.place);
  s.above = is_above(r, reach, s.place, s.distance_sq, offset, beside, s.z, s.scale);
  s.within = s.distance_sq < reach.radius_sq;
  return s;
}

Sample sample_at(Receiver r, Side side, Reach reach, float offset) {
  const vec2 beside = round(side.direction_px * offset);
  const ivec2 hit = r.pixel + ivec2(beside);
  return sample_of(r, side, reach, offset, beside, occluder_depth[hit.y * reach.width + hit.x]);
}

/// The pixel of a sample.
ivec2 pixel_at(Receiver r, Side side, float offset) { return r.pixel + ivec2(round(side.direction_px * offset)); }

/// The sample before the first one.
Sample receiver_sample(Receiver r) { return Sample(0.0, r.z, 1.0, vec2(0), 0.0, kBeyondSq, true, true); }

/// The samples of a search among which surfaces are interrupted, as bits: as many as a word has at a time.
const int kWordBits = 32;
struct Interruptions {
  int first;    // the sample of the lowest bit
  uint starts;  // those that begin a run
  uint jumps;   // of them those that are not connected to the one before, both above the tangent plane
};

/// Takes down what a sample begins. goes_on: the deeper one of it and the one before goes on where it is hidden.
void take_down(inout Interruptions found, int k, Sample s, Sample last, bool connected, bool goes_on, Reach reach) {
  const bool is_jump = both(both(both(!connected, !goes_on), last.offset > 0.0), both(s.above, last.above));
  const bool is_near = (s.z > last.z ? s.distance_sq : last.distance_sq) < kFarEnd * kFarEnd * reach.radius_sq;
  const uint bit = 1u << uint(k & (kWordBits - 1));
  found.starts |= !connected || !s.above ? bit : 0u;
  found.jumps |= both(is_jump, is_near) ? bit : 0u;
}

/// The piece by which the deeper one of two neighbouring samples, `at` and the one before, goes on behind the nearer
/// one: to the other end of that one's run, and on to the next run's beginning if that hides it too. behind_last: the
/// sample after the last one.
Piece piece_behind(Receiver r, Side side, Reach reach, Draw draw, int count, Interruptions found, int at,
                   int behind_last) {
  const uint bit = uint(at - found.first);
  const uint before = found.starts & ((1u << bit) - 1u), after = found.starts & ~((2u << bit) - 1u);
  const Sample s = sample_at(r, side, reach, step_offset(at, int(kSteps), count, side.reach, draw.jitter));
  const Sample last = sample_at(r, side, reach, step_offset(at - 1, int(kSteps), count, side.reach, draw.jitter));
  const bool is_back = s.z > last.z;  // the sample itself goes on, towards the receiver
  const vec2 end = is_back ? s.place : last.place, hider = is_back ? last.place : s.place;
  const int first_before = max(findMSB(before), 0), first_after = mix(findLSB(after), kWordBits, after == 0u);
  const int other =
      mix(min(found.first + first_after, behind_last) - 1, min(found.first + first_before, at - 1), is_back);
  const ivec2 hit = pixel_at(r, side, is_back ? s.offset : last.offset);
  const vec2 n = normal_in_slice(r, side, normal[hit.y * reach.width + hit.x]);
  const Sample opposite = sample_at(r, side, reach, step_offset(other, int(kSteps), count, side.reach, draw.jitter));
  const bool hides_all = dot(n, opposite.place - end) > 0.0;
  vec2 until = hides_all ? opposite.place : hider;
  const int next = mix(other + 1, other - 1, is_back);
  const bool goes_on = both(hides_all, both(next >= 0, next < behind_last));
  const Sample beyond = sample_at(
      r, side, reach, step_offset(clamp(next, 0, behind_last - 1), int(kSteps), count, side.reach, draw.jitter));
  until = both(goes_on, both(beyond.above, dot(n, beyond.place - end) > 0.0)) ? beyond.place : until;
  const vec2 onward = mix(vec2(n.y, -n.x), vec2(-n.y, n.x), bvec2(is_back));
  Piece piece = piece_of(reach, end, onward, seen_at(r, end, onward, n, until));
  piece.exists = both(piece.exists, both(is_told_by(n, r, end), dot(n, hider - end) > 0.0));
  return piece;
}

/// The sample so many steps from the receiver beyond the image's border: the plane of the border's nearest pixel goes
/// on there.
Sample sample_beyond(Receiver r, Side side, Reach reach, float offset) {
  const vec2 beside = side.direction_px * offset;
  const ivec2 pixel = r.pixel + ivec2(round(beside)), most = params.view.size - 1;
  const ivec2 nearest = clamp(pixel, ivec2(0), most), mirrored = clamp(2 * nearest - pixel, ivec2(0), most);
  const int index = nearest.y * reach.width + nearest.x;
  const vec3 n = octahedral_direction(unpackSnorm2x16(normal[index]));
  const vec2 from = tangent_of(params.view, vec2(nearest) + 0.5);
  // Not by the point's place on the image, which rounds otherwise in a part of the frame.
  const vec2 to = r.tangent + params.view.tangent_per_pixel * beside;
  const float z =
      depth_beyond(params.view, from, occluder_depth[index], n, tangent_of(params.view, vec2(mirrored) + 0.5),
                   occluder_depth[mirrored.y * reach.width + mirrored.x], to, kLeastFacingToGoOn);
  Sample s = sample_of(r, side, reach, offset, beside, z);
  const float height = height_of(r, beside, s.z, s.scale);
  s.above = both(z < kSkyDepth, both(s.above, height > kLeastRisen * reach.radius + r.least_height));
  return s;
}

// The receiver's own surface along a side: how far it falls below the tangent plane within the radius, and how far it
// rises above.
//
// Directions below the tangent plane are blocked inside where they meet the solid's own surface from within, nearer
// than the radius. As far as it is seen, those are the directions from the plane down to the surface's lowest place, as
// those above the plane are blocked outside up to its horizon. The integrals are the same, with the cosine turned
// round.
//
// The surface is made of samples that are linked from the receiver on, each to the one before. What it hides of itself
// is unknown. Where what lies behind its last sample is below the receiver's plane, it turns back along the eye's ray
// there: solids have edges or roundings at their outlines, and are taken to be as thick as the radius. Elsewhere it
// goes on along its last slope, as it does between the last sample and the radius, behind what is nearer, and beyond
// the border.

/// The own surface as far as a search has come. What lies in the loop over samples is without branches: lavapipe
/// computes both sides of each.
struct OwnSurface {
  bool is_linked;      // so is its last sample
  bool is_inside;      // and all samples were within the radius
  bool falls;          // where it ends inside, it goes on below the tangent plane
  float low, high;     // its smallest and largest slope_of() within the radius; 1 and -1: there is none
  vec2 place, onward;  // of its last sample inside, and where to it goes on from there; 0: along the eye's ray
  vec2 sum, last;      // with falloff: the weighed arcs, inside and outside, and those of all so far
};

OwnSurface own_surface() { return OwnSurface(true, true, false, 1.0, -1.0, vec2(0), vec2(0), vec2(0), vec2(0)); }

/// Takes the next sample. connected: it and the one before are one surface. rises: the largest slope that it blocks.
void follow(inout OwnSurface own, Receiver r, Reach reach, Sample s, Sample last, vec2 beside, bool connected,
            float rises) {
  // As clearly as is_above() asks for. What is infinitely far away has no elevation.
  const float height = height_of(r, beside, s.z, s.scale);
  const bool is_below = -height > r.least_height + s.scale * (reach.least_rise * s.offset);
  const bool falls = both(is_below, is_elevated(height, reach.per_elevation, s.distance_sq));
  const bool goes_on = both(own.is_inside, connected), turns = both(both(own.is_inside, is_below), s.z > last.z);
  const vec2 onward = s.place - own.place;
  own.onward.x = goes_on ? onward.x : turns ? 0.0 : own.onward.x;
  own.onward.y = goes_on ? onward.y : turns ? 0.0 : own.onward.y;
  own.falls = goes_on ? falls : turns ? true : own.falls;
  own.is_linked = both(own.is_linked, connected);
  own.is_inside = both(goes_on, s.within);
  own.place.x = own.is_inside ? s.place.x : own.place.x;
  own.place.y = own.is_inside ? s.place.y : own.place.y;
  own.low = lesser(both(own.is_inside, falls) ? s.slope : 1.0, own.low);
  own.high = greater(own.is_linked ? rises : -1.0, own.high);
}

/// The arc integrals of what it blocks, inside and outside.
vec2 arcs_of(OwnSurface own, Side side) {
  const float plane = slope_of(side.ahead);
  return vec2(own.low < plane ? whole_arc(side) - arc_to(side, place_at(own.low)) : 0.0,
              own.high > plane ? whole_arc(side) - arc_to(side, place_at(own.high)) : 0.0);
}

/// Lets it go on straight to the sphere of the radius from where it ends inside.
void end(inout OwnSurface own, Receiver r, Reach reach) {
  const float length_sq = dot(own.onward, own.onward);
  const vec2 d = length_sq > 0.0 ? own.onward * inversesqrt(length_sq) : away_from_eye(r, own.place);
  const float along = dot(own.place, d), beside_sq = reach.radius_sq - dot(own.place, own.place);
  const float low = slope_of(own.place + (sqrt(max(along * along + beside_sq, 0.0)) - along) * d);
  own.low = min(own.low, own.falls ? low : 1.0);
}
