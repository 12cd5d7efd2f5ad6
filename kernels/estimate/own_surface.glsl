// The receiver's own surface along a side: how far it falls away below its tangent plane within the radius, and how far
// it rises above. Pure: no bindings; to be included after pieces.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// A direction below the tangent plane is blocked inside if it meets the solid's own surface from within, nearer than
// the radius. As far as that surface is seen, those are the directions from the plane down to the lowest place of the
// surface, as those above the plane are blocked up to its horizon. The integrals are the same, with the cosine turned
// round.
//
// Its samples are linked from the receiver on, each to the one before. Where nothing is linked any more, at outlines
// and at the border, and where samples end before the radius, a surface that falls goes on along its last slope.

/// The own surface as far as a search has come. Angles go by slope_of().
struct OwnSurface {
  bool goes_on;
  bool falls;        // the last sample lies clearly below the tangent plane
  float low, high;   // its smallest and largest slope within the radius
  vec2 place, onward;  // the last sample's, and the way to it from the one before
  vec2 sum, last;    // with falloff: the weighed arcs of inside and outside, and those of all so far
};

OwnSurface own_surface(Side side) {
  return OwnSurface(true, false, slope_of(side.ahead), -1.0, vec2(0), vec2(0), vec2(0), vec2(0));
}

/// The arc integrals of what the surface blocks, inside and outside.
vec2 arcs_of(Side side, OwnSurface own) {
  const float plane = slope_of(side.ahead), whole = arc_to(side, place_at(plane));
  return vec2(own.low < plane ? whole - arc_to(side, place_at(own.low)) : 0.0,
              own.high > plane ? whole - arc_to(side, place_at(own.high)) : 0.0);
}

/// Whether a sample lies as clearly below the tangent plane as is_above() asks for above it.
bool is_below(Receiver r, Reach reach, Sample s, vec2 beside) {
  const float depth = -height_of(r, beside, s.z, s.scale);
  const bool clear = depth > r.least_height + s.scale * (reach.least_rise * s.offset);
  return both(s.place.x > 0.0, both(clear, is_elevated(depth, reach.per_elevation, s.distance_sq)));
}

/// slope_of() where a straight line leaves the sphere of the radius, from a place within.
float slope_of_exit(Reach reach, vec2 place, vec2 onward) {
  const float a = dot(onward, onward), b = dot(place, onward), c = dot(place, place) - reach.radius_sq;
  return slope_of(place + (sqrt(max(b * b - a * c, 0.0)) - b) / max(a, 1e-30) * onward);
}

/// Ends the surface at its last sample.
void end(inout OwnSurface own, Reach reach) {
  const bool is_open = both(both(own.goes_on, own.falls), dot(own.place, own.place) < reach.radius_sq);
  if (is_open) own.low = min(own.low, slope_of_exit(reach, own.place, own.onward));
  own.goes_on = false;
}

/// Takes the next sample. connected: it and the one before are one surface. rises: the largest slope that it blocks.
void follow(inout OwnSurface own, Receiver r, Side side, Reach reach, Sample s, vec2 beside, bool connected,
            float rises, float last_z) {
  // Before what lies behind it and below its plane it has ended: there it turns along the eye's ray.
  const float depth = -height_of(r, beside, s.z, s.scale);
  if (both(own.goes_on, both(both(!connected, s.z > last_z), depth > r.least_height + s.scale * (reach.least_rise * s.offset)))) {
    own.falls = true;
    own.onward = away_from_eye(r, own.place);
  }
  if (!connected) end(own, reach);
  if (!own.goes_on) return;
  const bool falls = is_below(r, reach, s, beside), was_within = dot(own.place, own.place) < reach.radius_sq;
  if (both(falls, s.within)) own.low = min(own.low, s.slope);
  if (both(falls, both(was_within, !s.within)))
    own.low = min(own.low, slope_of_exit(reach, own.place, s.place - own.place));
  own.high = max(own.high, rises);
  own.onward = s.place - own.place;
  own.place = s.place;
  own.falls = falls;
}
