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
