// The receiver's own surface along a side: how far it falls below the tangent plane within the radius, and how far it
// rises above. Pure: no bindings; to be included after pieces.glsl.
// SPDX-License-Identifier: BSD-3-Clause
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

/// The own surface as far as a search has come.
struct OwnSurface {
  bool goes_on;
  bool falls;          // its last sample lies below the tangent plane
  float low, high;     // its smallest and largest slope_of() within the radius; 1 and -1: there is none
  vec2 place, onward;  // its last sample's, and the way to that from the one before
  vec2 sum, last;      // with falloff: the weighed arcs, inside and outside, and those of all so far
};

OwnSurface own_surface() { return OwnSurface(true, false, 1.0, -1.0, vec2(0), vec2(0), vec2(0), vec2(0)); }

/// The arc integrals of what it blocks, inside and outside.
vec2 arcs_of(Side side, OwnSurface own) {
  const float plane = slope_of(side.ahead);
  const vec2 arcs = vec2(arc_to(side, place_at(min(own.low, plane))), arc_to(side, place_at(max(own.high, plane))));
  return arc_to(side, place_at(plane)) - arcs;
}

/// Whether a sample lies below the tangent plane as clearly as is_above() asks for above it.
bool is_below(Receiver r, Reach reach, Sample s, vec2 beside) {
  const float depth = -height_of(r, beside, s.z, s.scale);
  const bool is_sloping = s.z < kSkyDepth ? is_elevated(depth, reach.per_elevation, s.distance_sq) : true;
  return both(depth > r.least_height + s.scale * (reach.least_rise * s.offset), is_sloping);
}

/// slope_of() where a straight line from a place within the sphere of the radius leaves it.
float slope_of_exit(Reach reach, vec2 place, vec2 onward) {
  const vec2 d = onward * inversesqrt(max(dot(onward, onward), 1e-37));
  const float along = dot(place, d);
  return slope_of(place + (sqrt(max(along * along - dot(place, place) + reach.radius_sq, 0.0)) - along) * d);
}

/// Ends it at its last sample.
void end(inout OwnSurface own, Reach reach) {
  if (both(both(own.goes_on, own.falls), dot(own.place, own.place) < reach.radius_sq))
    own.low = min(own.low, slope_of_exit(reach, own.place, own.onward));
  own.goes_on = false;
}

/// Takes the next sample. connected: it and the one before are one surface. rises: the largest slope that it blocks.
void follow(inout OwnSurface own, Receiver r, Reach reach, Sample s, Sample last, vec2 beside, bool connected,
            float rises) {
  if (!own.goes_on) return;
  const bool falls = is_below(r, reach, s, beside);
  if (!connected) {
    const bool turns = both(falls, s.z > last.z);
    own.falls = turns ? true : own.falls;
    own.onward = turns ? away_from_eye(r, own.place) : own.onward;
    end(own, reach);
    return;
  }
  const vec2 onward = s.place - own.place;
  const bool leaves = both(!s.within, dot(own.place, own.place) < reach.radius_sq);
  if (both(falls, s.within)) own.low = min(own.low, s.slope);
  if (both(falls, leaves)) own.low = min(own.low, slope_of_exit(reach, own.place, onward));
  own.high = max(own.high, rises);
  own.falls = falls;
  own.place = s.place;
  own.onward = onward;
}
