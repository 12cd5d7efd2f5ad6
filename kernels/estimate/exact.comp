// Ambient occlusion from every pixel along a slice, cosine weighted, with occluders of finite thickness: one slice of
// every pixel.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, the profiles of the lines of one direction.
// Out: the sums of blocked and of whole arcs; after the last direction visibility, 1 = open. The same of the moments of
// what is blocked (see moments.glsl), where they are asked for.
//
// horizon.comp takes samples; this kernel searches without gaps. It has the same integrals, over slices of its
// own. The steps have their numbers at the code:
//  1. Slices are even on the image and shared by all pixels. Each weighs 1 / (ray_length of the line's foot * cosine
//     from it), the Jacobian to azimuth about the view ray.
//  2. The receiver is moved onto its line's plane along its tangent plane, by half a pixel at most: a flat surface
//     stays flat.
//  3. On each side the receiver walks from vertex to vertex of the profile of its line (profile.comp), whose strokes
//     hold all pixels in between, until the sphere of the radius is left behind.
//  4. Where hidden surfaces are known, the line has a profile in each of several slots, and a walk goes along each. The
//     receiver's own surface goes on in the slot that it is in; all others add what they block to the same union. A run
//     there that passes behind the receiver is cut at the eye's ray. A vertex that knows how thick its surface's solid
//     is has that thickness.
//  5. Where surfaces are completed, a stroke is drawn on to where its surface goes on unseen (complete.comp). The
//     surface that goes on towards the receiver behind the end of a walk is the last one. Beyond the border go on the
//     planes of its pixels.
//  6. Every stroke is cut to the part within the sphere. A stroke before the sphere blocks by the part of its solid
//     within the sphere.
//  7. A stroke blocks from its front to its back, which lies as far along the eye's ray as its run is solid there
//     (profile.comp). What goes on from the receiver is its own surface: it blocks all below its horizon. Behind a
//     run's end a hidden face may close its solid.
//  8. What is blocked is a union of intervals. It is exact for what joins the horizon; all others are counted in 24
//     sectors (sectors.glsl). Its arcs are integrated in closed form (slice.glsl).
//  9. The result is 1 - (sum of blocked arcs) / (sum of whole arcs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/exact.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/noise.glsl"
#include "kernels/base/moments.glsl"
#include "kernels/estimate/arc_moments.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/sectors.glsl"
#include "kernels/estimate/lines.glsl"
#include "kernels/estimate/strokes.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
// 1: the pixels of listed tiles take the slice, and no sum is ever completed; see stride, first, is_last
layout(constant_id = 0) const uint kListed = 0;
// bits of kExact*: where surfaces go on, and whether what they block so is told apart
layout(constant_id = 1) const uint kCompletes = 0;
layout(constant_id = 2) const uint kOrder = 0;  // of moments, 0 to 2
layout(constant_id = 3) const uint kSlots = 1;  // of the profile, 1 to 1 + kMostHidden
// 1: behind the slots' planes is one of the first surfaces, which go on unseen where no slot goes on
layout(constant_id = 4) const uint kUnseen = 0;
layout(scalar, push_constant) uniform Push { ExactParams params; };
readonly buffer Depth { float depth[]; };       // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };      // one uint per pixel, from prepare
readonly buffer Vertex { float vertex[]; };     // from profile
readonly buffer Mark { uint mark[]; };          // from profile
readonly buffer Solid { uint solid[]; };        // from profile
readonly buffer Neighbor { uint neighbor[]; };  // from profile
buffer Whole { float whole_arcs[]; };           // one float per pixel, sum of whole arcs
// one float per pixel, sum of blocked arcs; after the last slice visibility in [0, 1], 1 = open
buffer Ao { float ao[]; };
readonly buffer List { uint list[]; };          // one uint per tile, from converge; only with kListed
readonly buffer Counts { TileCounts counts; };  // only with kListed
readonly buffer GoesOn { uint goes_on[]; };     // from complete; only with kExactBehind
readonly buffer Behind { uint behind[]; };      // from complete; only with kExactBehind
// one float per pixel, visibility that completed surfaces took; only with kExactApart
buffer Completed { float completed[]; };
// planes of the sums of the moments of what is blocked, in view space; after the last slice the mean ones, see
// stored_moment(). Only with kOrder.
buffer Moments { float moments[]; };
readonly buffer Own { uint own[]; };  // from profile; only with several kSlots
// one float per pixel, depth of the first surfaces that may block; only with kExactBorder
readonly buffer Occluders { float occluder_depth[]; };

const bool kGoesBeyond = (kCompletes & kExactBorder) != 0u;
const bool kGoesOn = (kCompletes & kExactBehind) != 0u;
const bool kTellsApart = (kCompletes & kExactApart) != 0u;

/// A vertex that stands alone is the end of a stroke from this part of its distance on: so short that its depth within
/// the sphere and its slopes are those of the vertex within 0.1 %, and long enough not to be lost in rounding.
const float kShortStroke = 0.999;

/// A walk from vertex to vertex of one side.
struct Walk {
  vec2 last;             // the vertex before, in (across, toward)
  bool starts;           // there is none yet
  bool is_own;           // the run is the receiver's own surface
  bool is_rest;          // the run is what the receiver's own surface is not sure to go on with
  float thickness;       // scene units, where the stroke begins
  float last_thickness;  // where it ends
};

/// The stroke that ends at a vertex `steps` from the receiver. It begins at the vertex before. Nothing is seen before
/// the first vertex of a side, to which it begins at the pixel next to the receiver. A vertex that begins a run stands
/// alone, as a stroke that is short.
Stroke stroke_to(vec2 place, Walk walk, bool begins, int steps) {
  const float next_pixel = min(kShortStroke, 1.0 / float(steps));
  const vec2 onward = walk.starts ? next_pixel * place : walk.last;
  return Stroke(begins ? kShortStroke * place : onward, place);
}

/// The receiver in the plane of its line, where the profile has its vertices too.
struct Point {
  vec2 place, eye;     // eye: unit, towards it
  vec2 normal;         // the normal's projection; its length is the slice's weight
  float eye_distance;  // orthographic: infinite
};

/// One side of a slice.
struct Search {
  vec2 across;  // unit, to that side of the eye's ray
  // unit normal of the eye's ray that touches the sphere of the radius, in (across, toward): what is further along it
  // is beyond the sphere
  vec2 leaving;
  vec2 normal;                       // the normal's projection, in (across, toward)
  float lowest;                      // slope_of() where blocking begins
  float least_height, least_rise;    // of what blocks: see clearance.glsl
  int from;                          // the receiver's step
  int step;                          // of columns, to that side
  uint begins, last, apart, closes;  // the flags of vertices to that side
  float shift;                       // of the sectors' boundaries, in [0, 1): see sectors.glsl
  float unit;                        // scene units: a power of two near the receiver's depth
};

/// One side of a receiver's line: what all steps of its search share.
struct Context {
  View view;
  Lines lines;
  int line;
  ivec2 steps;  // of the line on the image; only with kExactBorder
  float z;      // the receiver's depth
  LinePlane plane;
  Point point;
  Side side;
  Search search;
  int row;          // index of the line's column 0 in each plane of the profile
  int slot;         // of the receiver's own surface
  float radius_sq;  // of the sphere beyond which nothing blocks
};

/// The blocked directions of a side.
struct Blocked {
  float own;     // slope_of() up to which the receiver's own surface blocks
  uint sectors;  // that other runs block
};

Point point_of(View view, LinePlane plane, vec2 tangent, float z, vec3 normal) {
  const bool perspective = view.orthographic == 0;
  const vec3 along = vec3(plane.along, 0);
  const vec3 away = away_of(view, plane);
  const vec3 across = cross(along, away);
  const vec3 position = perspective ? z * vec3(tangent, -1) : vec3(tangent - plane.foot, -z);
  const vec2 in_plane = vec2(dot(normal, along), dot(normal, away));
  const float beside =
      dot(position, across) * dot(normal, across) / max(dot(in_plane, in_plane), kLeastWeight * kLeastWeight);
  Point point;
  point.normal = in_plane;
  point.place = vec2(dot(position, along), dot(position, away)) + beside * in_plane;
  point.eye_distance = perspective ? length(point.place) : kNone;
  point.eye = perspective ? -point.place / point.eye_distance : vec2(0, -1);
  return point;
}

/// The side of a receiver's slice in which its line has rising numbers of steps (sign 1), or falling ones (-1).
Side side_of(Point point, float weight, int sign) {
  const vec2 across_eye = vec2(-point.eye.y, point.eye.x);
  Side side;
  side.cos_gamma = max(dot(point.normal, point.eye), kLeastWeight) / weight;
  side.sin_gamma = float(sign) * dot(point.normal, across_eye) / weight;
  side.gamma = angle_of(side.cos_gamma, side.sin_gamma);
  side.ahead = vec2(side.cos_gamma, -side.sin_gamma);
  return side;
}

/// The search of a side, from the receiver's step on.
Search search_of(View view, Point point, Side side, float weight, float clearance, float z, int from, int sign) {
  const float sine = params.radius / point.eye_distance, cosine = sqrt(max(0.0, 1.0 - sine * sine));
  const float lift = max(params.bias, kLeastElevation), level = sqrt(1.0 - lift * lift);
  Search search;
  search.across = float(sign) * vec2(-point.eye.y, point.eye.x);
  search.leaving = sine < 1.0 ? vec2(cosine, sine) : vec2(0);
  search.normal = weight * vec2(side.sin_gamma, side.cos_gamma);
  search.lowest =
      slope_of(vec2(level * side.cos_gamma + lift * side.sin_gamma, lift * side.cos_gamma - level * side.sin_gamma));
  search.least_height = clearance;
  search.least_rise = least_rise(view);
  search.from = from;
  search.step = sign;
  search.begins = sign > 0 ? kVertexBegins : kVertexEnds;
  search.last = sign > 0 ? kVertexLast : kVertexFirst;
  search.apart = sign > 0 ? kVertexApart : kVertexApartAgainst;
  search.closes = sign > 0 ? kVertexCloses : kVertexClosesAgainst;
  search.shift = fract(0.5 + kGolden * float(2u * params.direction + uint(sign > 0)));
  search.unit = power_of_two(z);
  return search;
}

/// A vertex at which a walk stops.
struct Stop {
  int at;  // its index
  uint marked;
  int step;      // of the line
  float z;       // planar depth
  bool goes_on;  // its surface goes on there unseen
};

Stop stop_at(int at) {
  const uint marked = mark[at];
  const float stored = vertex[at];
  return Stop(at, marked, int(marked >> 16), kGoesOn ? abs(stored) : stored, stored < 0.0);
}

/// Whether a run begins at a vertex, as the walk meets it; and whether the receiver's own is not sure to go on there.
bool begins_run(Stop stop, Search search) { return (stop.marked & search.begins) != 0u; }
bool is_apart(Stop stop, Search search) { return (stop.marked & search.apart) != 0u; }

/// A vertex as the receiver sees it, and the place up to which its surface goes on unseen.
struct Corner {
  vec2 place, unseen;  // in (across, toward)
  float least;         // the height above the tangent plane that blocks
};

/// A place in the plane of the line, as seen from the receiver.
vec2 from_receiver(Context c, vec2 place) {
  const vec2 offset = place - c.point.place;
  return vec2(dot(offset, c.search.across), dot(offset, c.point.eye));
}

vec2 place_of(Context c, Stop stop) { return from_receiver(c, place_at(c.view, c.plane, float(stop.step), stop.z)); }

/// further_at: the index at which it is told how the surface goes on.
Corner corner_of(Context c, Stop stop, int further_at, bool toward) {
  Corner corner;
  const float scale = c.view.orthographic != 0 ? 1.0 : stop.z;
  corner.least = c.search.least_height + scale * c.search.least_rise * float(abs(stop.step - c.search.from));
  corner.place = place_of(c, stop);
  corner.unseen = corner.place;
  if (kGoesOn) {
    const uint further = goes_on[further_at];
    const float until = float(stop.step) + float(toward ? -c.search.step : c.search.step) * steps_of_goes_on(further);
    corner.unseen = from_receiver(c, place_at(c.view, c.plane, until, stop.z * depths_of_goes_on(further)));
  }
  return corner;
}

/// The part of a stroke that the eye sees before the sphere or within it.
Stroke before_sphere(Stroke stroke, vec2 leaving) {
  const float from = dot(stroke.from, leaving) - params.radius, to = dot(stroke.to, leaving) - params.radius;
  const vec2 end = mix(stroke.from, stroke.to, from / (from - to));
  return Stroke(both(from > 0.0, to < 0.0) ? end : stroke.from, both(to > 0.0, from < 0.0) ? end : stroke.to);
}

/// 6. and 7. Adds what a stroke blocks from its front to its back: more of what the receiver's own surface does, or a
/// set apart. It belongs to the vertex at a corner. goes_on: from there on it is not seen, or up to there, and need not
/// be straight with what is; both hang together there, so they block one interval.
void block(inout Blocked blocked, Walk walk, Context c, Stroke stroke, Corner corner, bool goes_on) {
  const Search search = c.search;
  const float eye_distance = c.point.eye_distance, radius_sq = c.radius_sq;
  const Clipped front = clip_to_sphere(stroke, radius_sq, search.unit);
  const bool is_within = both(front.is_within, min(front.near.x, front.far.x) > 0.0);
  const float near_slope = slope_of(front.near), far_slope = slope_of(front.far);
  // The largest and the smallest slope of what lies within the sphere.
  vec2 slopes = is_within ? vec2(max(near_slope, far_slope), min(near_slope, far_slope)) : vec2(-1, 1);
  float height = is_within ? max(dot(front.near, search.normal), dot(front.far, search.normal)) : -kNone;
  const bool bends = kGoesOn && goes_on;
  if (walk.is_own || walk.thickness >= kNone) {
    // What has no end blocks by its front within the sphere alone.
    const bool bends_within = both(bends, dot(corner.place, corner.place) < radius_sq);
    const float bend = slope_of(corner.place);
    slopes.y = is_within ? min(back_of(front.far, eye_distance, radius_sq), slopes.y) : slopes.y;
    slopes.x = bends_within ? max(bend, slopes.x) : slopes.x;
    slopes.y = bends_within ? min(back_of(corner.place, eye_distance, radius_sq), min(bend, slopes.y)) : slopes.y;
    height = bends_within ? max(dot(corner.place, search.normal), height) : height;
  } else {
    const Stroke ends = before_sphere(stroke, search.leaving);
    Stroke back;
    const vec2 from = depths_of(ends.from, eye_distance, walk.thickness, radius_sq, back.from);
    const vec2 to = depths_of(ends.to, eye_distance, walk.last_thickness, radius_sq, back.to);
    slopes = vec2(max(to.x, max(from.x, slopes.x)), min(to.y, min(from.y, slopes.y)));
    // Behind a part of the stroke alone the solid may reach into the sphere, or farther down in it than at the ends.
    const Clipped ends_back = clip_to_sphere(back, radius_sq, search.unit);
    const bool is_solid = both(ends_back.is_within, min(ends_back.near.x, ends_back.far.x) > 0.0);
    const float a = slope_of(ends_back.near), b = slope_of(ends_back.far);
    slopes = is_solid ? vec2(max(a, max(b, slopes.x)), min(a, min(b, slopes.y))) : slopes;
    height = is_solid || from.x >= from.y ? max(dot(ends.from, search.normal), height) : height;
    height = is_solid || to.x >= to.y ? max(dot(ends.to, search.normal), height) : height;
    if (bends) {
      vec2 unused;
      const vec2 bend = depths_of(corner.place, eye_distance, walk.last_thickness, radius_sq, unused);
      slopes = vec2(max(bend.x, slopes.x), min(bend.y, slopes.y));
      height = bend.x >= bend.y ? max(dot(corner.place, search.normal), height) : height;
    }
  }
  const float top = both(slopes.x > search.lowest, height > corner.least) ? slopes.x : -1.0;
  const float bottom = walk.is_own ? -1.0 : slopes.y;
  const bool onto_own = bottom <= blocked.own;
  blocked.sectors |=
      onto_own || top < bottom ? 0u : sectors_below(top, search.shift) & ~sectors_below(bottom, search.shift);
  blocked.own = onto_own ? max(blocked.own, top) : blocked.own;
}

/// The column of the nearest vertex beyond the end of a walk at `at` whose surface goes on towards the receiver behind
/// that end.
uint vertex_beyond(Context c, int at) {
  const uint columns = behind[kSlots > 1u ? at - int(kSlots) * c.view.size.x * c.view.size.y : at];
  return c.search.step > 0 ? columns >> 16 : columns & kNoVertex;
}

/// The blocked part of a side's arc integral. Where the receiver's own surface blocks nothing, it adds exactly 0.
float arc_of(Side side, Search search, Blocked blocked) {
  const float own = whole_arc(side) - arc_to(side, place_at(blocked.own));
  return (blocked.own > slope_of(side.ahead) ? own : 0.0) +
         arc_of(side, blocked.sectors & ~sectors_below(blocked.own, search.shift));
}

/// first_to() over what is blocked, and second_to(); exactly 0 where the own surface blocks nothing, too.
mat2 moments_of(Side side, Search search, Blocked blocked) {
  mat2 own = mat2(0);
  if (blocked.own > slope_of(side.ahead)) {
    const vec2 top = normalize(place_at(blocked.own));
    const float cosine = side.cos_gamma, sine = side.sin_gamma, end = side.gamma + kHalfPi;
    own[0] = first_to(-sine, cosine, cosine, sine) - first_to(top.y, top.x, cosine, sine);
    if (kOrder > 1u)
      own[1] =
          second_to(-sine, cosine, end, cosine, sine) - second_to(top.y, top.x, angle_of(top.y, top.x), cosine, sine);
  }
  const uint others = blocked.sectors & ~sectors_below(blocked.own, search.shift);
  return own + mat2(first_of(side, others), kOrder > 1u ? second_of(side, others) : vec2(0));
}

/// The blocked part of a side's integrals.
struct BlockedArcs {
  float arc;
  float unseen;  // of the arc: what only completed surfaces block; only with kExactApart
  mat2 moments;  // across the eye's ray and towards it; only with kOrder
};

/// The walks along the profiles of a line: one of each slot, and one for what is unseen.
const int kWalks = int(kSlots + (kUnseen != 0u ? 1u : 0u));

/// Farther away than any step of a line.
const int kNever = 0x10000;

/// The next vertices of the walks of a side.
struct Next {
  int at[kWalks];    // index
  int away[kWalks];  // steps from the receiver; kNever: there is none
  float z[kWalks];
};

bool is_over(Next next) {
  bool is_over = true;
  for (int i = 0; i < kWalks; i++) is_over = is_over && next.away[i] == kNever;
  return is_over;
}

/// The walk whose vertex is the nearest, on the image and then to the eye: so runs are met in one order whichever slots
/// they have. That for what is unseen comes last.
int nearest_walk(Next next) {
  int best = 0;
  for (int i = 1; i < kWalks; i++) {
    const bool ties = next.away[i] == next.away[best] && next.z[i] < next.z[best];
    best = next.away[i] < next.away[best] || ties ? i : best;
  }
  return best;
}

/// Goes on with a walk at an index, or ends it.
void go_to(inout Next next, Search search, int walk, int at, bool ends) {
  int away = kNever;
  float z = 0.0;
  if (!ends) {
    const Stop stop = stop_at(at);
    away = abs(stop.step - search.from);
    z = stop.z;
  }
  for (int i = 0; i < kWalks; i++) {
    const bool is_it = i == walk;
    next.at[i] = is_it ? at : next.at[i];
    next.away[i] = is_it ? away : next.away[i];
    next.z[i] = is_it ? z : next.z[i];
  }
}

/// The column of the first vertex on a side; kNoVertex: none.
uint first_column(Search search, int index) {
  const uint columns = neighbor[index];
  return search.step > 0 ? columns >> 16 : columns & kNoVertex;
}

/// The first vertices of all walks on a side.
void first_vertices(Context c, inout Next next) {
  for (int i = 0; i < kWalks; i++) {
    const int first = i * c.view.size.x * c.view.size.y + c.row;
    const uint column = first_column(c.search, first + c.search.from);
    go_to(next, c.search, i, first + int(column), column == kNoVertex);
  }
}

/// The thickness at a vertex.
float thickness_at(Search search, int at) {
  const float known = unpack_thickness(solid[at], search.step > 0);
  return known > 0.0 ? known : min(params.thickness, kNone);
}

/// The thickness of a whole run at a vertex of it. Where the receiver's own run may end, the vertex before tells it.
float whole_thickness_at(Search search, int at) {
  while ((mark[at] & search.apart) != 0u && (mark[at] & search.begins) == 0u) at -= search.step;
  return thickness_at(search, at);
}

/// Comes to a vertex from the one before, where there are several walks. A run that passes behind the receiver is cut
/// beside the eye's ray.
void come_to(inout Walk walk, Context c, Stop stop, vec2 place, bool begins) {
  const float here = begins ? thickness_at(c.search, stop.at) : whole_thickness_at(c.search, stop.at);
  walk.thickness = here;
  walk.last_thickness = here;
  if (!walk.starts && !begins) {
    const Stop before = stop_at(stop.at - c.search.step);
    const vec2 from = place_of(c, before);
    const float least = kBesideReceiver * place.x;
    const bool is_behind = both((before.step - c.search.from) * c.search.step <= 0, from.x < least);
    const float part = is_behind ? (place.x - least) / (place.x - from.x) : 1.0;
    const float last = whole_thickness_at(c.search, before.at);
    walk.last = is_behind ? place + part * (from - place) : from;
    walk.thickness = is_behind ? here - part * (here - last) : last;
  }
}

/// Whether a walk ends with this vertex: it is the last, or the sphere is left behind.
bool ends_at(Stop stop, Corner corner, Search search) {
  return (stop.marked & search.last) != 0u || !(dot(corner.place, search.leaving) < params.radius);
}

/// The directions that a side's strokes block.
struct Found {
  Blocked all;
  Blocked seen;  // without what completed surfaces block; only with kExactApart
};

/// 5. to 7. Adds the stroke that ends at a vertex. goes_on: its surface goes on there unseen.
void add_stroke(inout Found found, Walk walk, Context c, Stroke stroke, Corner corner, bool begins, bool goes_on) {
  if (kTellsApart) block(found.seen, walk, c, stroke, corner, false);
  // What is seen from the receiver to the first vertex need not be straight with what goes on there: where that is
  // beyond the sphere, only the former matters.
  const bool is_first_beyond = both(walk.starts, dot(corner.place, corner.place) > c.radius_sq);
  const bool draws_on = kGoesOn && goes_on && !is_first_beyond;
  if (kGoesOn) {
    const Stroke whole = with_unseen(stroke, begins, corner.unseen);
    stroke.from = draws_on ? whole.from : stroke.from;
    stroke.to = draws_on ? whole.to : stroke.to;
  }
  block(found.all, walk, c, stroke, corner, draws_on);
}

/// 5. Adds the surface that goes on towards the receiver behind the end of a walk. last: the walk's last vertex; below
/// 0: there is none.
void add_beyond(inout Found found, Context c, int last) {
  const bool looks_beyond = kGoesOn && (kSlots == 1u || kUnseen != 0u) && last >= 0;
  const uint beyond = looks_beyond ? vertex_beyond(c, last) : kNoVertex;
  if (beyond != kNoVertex) {
    const Stop stop = stop_at((kWalks - 1) * c.view.size.x * c.view.size.y + c.row + int(beyond));
    const Corner corner = corner_of(c, stop, stop.at, true);
    const float thickness = params.thickness == 0.0 || kWalks > 1 ? thickness_at(c.search, stop.at) : params.thickness;
    const Walk walk = Walk(vec2(0), false, false, false, thickness, thickness);
    const Stroke stroke = with_unseen(Stroke(corner.place, corner.place), true, corner.unseen);
    block(found.all, walk, c, stroke, corner, true);
  }
}

/// Samples of a side beyond the border, up to so many radii at the receiver's depth, and no more steps than that.
const int kStepsBeyond = 8;
const float kReachBeyond = 1.2, kMostBeyond = 2000.0;

/// The depth at a step of the line beyond the border, counted from the display window's corner: the plane of the
/// border's nearest pixel goes on there. kSkyDepth: nothing does.
float depth_at_step(Context c, LinePlane plane, float at) {
  const ivec2 extent = extent_of(c.view, c.lines), origin = c.lines.origin;
  const float across = float(c.line + origin.y) + float(c.lines.slope) / float(kSlopeUnit) * at;
  const ivec2 pixel = ivec2(floor(vec2(at, across) + 0.5)) - origin;
  const ivec2 nearest = clamp(pixel, ivec2(0), extent - 1), mirrored = clamp(2 * nearest - pixel, ivec2(0), extent - 1);
  const int index = index_at(c.view, c.lines, nearest.x, nearest.y);
  const vec2 from = tangent_at(c.view, c.lines, nearest + origin);
  const vec2 to = plane.foot + (plane.start + at * plane.step) * plane.along;
  const float mirrored_z = occluder_depth[index_at(c.view, c.lines, mirrored.x, mirrored.y)];
  return depth_beyond(c.view, from, occluder_depth[index], unpack_normal(normal[index]),
                      tangent_at(c.view, c.lines, mirrored + origin), mirrored_z, to, kLeastFacingToGoOn);
}

/// 5. Adds what goes on beyond the image's border. With `auto` it is as thick as it is wide there so far, and
/// kCutThickness radii at most.
void add_border(inout Found found, Context c) {
  const int border = c.search.step > 0 ? c.steps.y - 1 : c.steps.x;
  const bool perspective = c.view.orthographic == 0;
  // Steps are counted from the display window's corner, so that a part of the frame rounds as the whole does.
  LinePlane plane = c.plane;
  plane.origin = 0;
  const float first = float(border + c.plane.origin);
  const float whole = kReachBeyond * params.radius / (plane.step * (perspective ? c.z : 1.0));
  const float rest = min(whole - float(abs(border - c.search.from)), kMostBeyond);
  Walk walk = Walk(vec2(0), false, false, false, 0.0, 0.0);
  float last_z = kSkyDepth, last_at = first;
  vec2 last = vec2(0), start = vec2(0);
  // Whether a step lies within the sphere's image is the same at any depth.
  bool goes =
      rest > 0.0 && dot(from_receiver(c, place_at(c.view, plane, first, c.z)), c.search.leaving) < params.radius;
  int i = 0;
  if (goes) {
    do {
      const float part = max(float(i) - 1.0 + c.search.shift, 0.0) / float(kStepsBeyond);
      const float at = i == 0 ? first : first + float(c.search.step) * (rest * part);
      const float z = depth_at_step(c, plane, at);
      Corner corner;
      corner.place = from_receiver(c, place_at(c.view, plane, at, z < kSkyDepth ? z : 1.0));
      corner.unseen = corner.place;
      corner.least = c.search.least_height + kLeastRisen * params.radius;
      const float slope = kRunSlope * c.view.tangent_per_pixel.x * abs(at - last_at);
      const bool joins = abs(z - last_z) < slope * (perspective ? min(z, last_z) : 1.0);
      start = joins ? start : corner.place;
      const float gap = rest / float(kStepsBeyond) * plane.step * (perspective ? z : 1.0);
      const float width = length(corner.place - start) + gap;
      walk.thickness = params.thickness > 0.0 ? params.thickness : min(width, kCutThickness * params.radius);
      walk.last_thickness = walk.thickness;
      if (z < kSkyDepth && corner.place.x > 0.0)
        block(found.all, walk, c, Stroke(joins ? last : kShortStroke * corner.place, corner.place), corner, false);
      last = corner.place;
      last_z = z;
      last_at = at;
      goes = i < kStepsBeyond && dot(corner.place, c.search.leaving) < params.radius;
      i++;
    } while (goes);
  }
}

/// 8. The integrals over what is blocked.
BlockedArcs arcs_of(Context c, Found found) {
  const float arc = arc_of(c.side, c.search, found.all);
  return BlockedArcs(arc, kTellsApart ? arc - arc_of(c.side, c.search, found.seen) : 0.0,
                     kOrder > 0u ? moments_of(c.side, c.search, found.all) : mat2(0));
}

/// 7. The thickness from the last vertex to this one. What is left of a run has one thickness, and the vertex where it
/// begins knows none of the whole run.
void thicken(inout Walk walk, Search search, Stop stop, bool begins) {
  const bool changes = begins || !walk.is_rest && !is_apart(stop, search);
  const float here = changes ? thickness_at(search, stop.at) : walk.last_thickness;
  walk.thickness = begins ? here : walk.last_thickness;
  walk.last_thickness = here;
}

/// 7. Where a hidden face closes the solid behind the vertex that begins a run, across its own face, the stroke from
/// the face's end to the vertex, which has the whole thickness: what is behind both hangs together there.
void close_solid(inout Walk walk, inout Stroke stroke, Context c, Stop stop) {
  if ((stop.marked & c.search.closes) == 0u) return;
  const int pixel = index_at(c.view, c.lines, stop.step, c.line + shift_at(c.lines, stop.step));
  const vec2 n = in_plane(c.view, c.plane, unpack_normal(normal[pixel]));
  const vec2 back = vec2(dot(n, c.search.across), dot(n, c.point.eye));
  stroke.from = with_unseen(stroke, true, stroke.to - walk.thickness * back).from;
  walk.thickness = 0.0;
}

/// 3. Walks along one profile. Gives its last vertex; below 0: there is none.
int walk_along(inout Found found, Context c) {
  const Search search = c.search;
  Walk walk = Walk(vec2(0), true, true, false, params.thickness, params.thickness);
  const uint first = first_column(search, c.row + search.from);
  int at = c.row + int(first), last = -1;
  bool goes = first != kNoVertex;
  if (goes) {
    do {
      last = at;
      const Stop stop = stop_at(at);
      const bool begins_a_run = begins_run(stop, search);
      const bool begins = begins_a_run || walk.is_own && is_apart(stop, search);
      const Corner corner = corner_of(c, stop, at, begins);
      walk.is_rest = begins ? !begins_a_run : walk.is_rest;
      walk.is_own = begins ? false : walk.is_own;
      if (params.thickness == 0.0 && !walk.is_own) thicken(walk, search, stop, begins);
      Stroke stroke = stroke_to(corner.place, walk, begins, abs(stop.step - search.from));
      if (begins_a_run) close_solid(walk, stroke, c, stop);
      add_stroke(found, walk, c, stroke, corner, begins, stop.goes_on);
      goes = !ends_at(stop, corner, search);
      walk.last = corner.place;
      walk.starts = false;
      at += search.step;
    } while (goes);
  }
  return last;
}

/// 4. The walk along the slot of the receiver's own surface, among several.
struct OwnSlot {
  bool is_own, starts;  // as of its Walk
  bool rests;           // its run is what the own surface is not sure to go on with
  float rest;           // scene units: how thick that is
};

/// The walk at a vertex of one slot. `is_in_own`: the slot is the receiver's. `is_parted`: the own surface is not sure
/// to go on there.
Walk walk_of_slot(inout OwnSlot own, Context c, Stop stop, vec2 place, bool is_in_own, bool begins, bool is_parted) {
  own.is_own = is_in_own && begins ? false : own.is_own;
  Walk walk = Walk(vec2(0), is_in_own && own.starts, is_in_own && own.is_own, false, 0.0, 0.0);
  own.starts = is_in_own ? false : own.starts;
  come_to(walk, c, stop, place, begins);
  if (is_in_own && begins) {
    own.rests = is_parted;
    own.rest = walk.thickness;
  }
  if (is_in_own && own.rests) {
    walk.thickness = own.rest;
    walk.last_thickness = own.rest;
  }
  return walk;
}

/// The vertex of a slot's walk in that for what is unseen too, if the run begins or ends there in both.
struct Twin {
  bool exists, goes_on;
};

Twin twin_of(Next next, Search search, Stop stop) {
  const int walk = kWalks - 1;
  const bool meets = next.away[walk] == abs(stop.step - search.from) && next.z[walk] == stop.z;
  const int at = meets ? next.at[walk] : stop.at;
  const bool exists = meets && ((mark[at] ^ stop.marked) & (kVertexBegins | kVertexEnds)) == 0u;
  return Twin(exists, exists && vertex[at] < 0.0);
}

/// 4. Walks along several profiles, vertex by vertex as they come. Gives the last vertex of that for what is unseen.
int walk_along_all(inout Found found, Context c) {
  const Search search = c.search;
  const int unseen = kWalks - 1;
  Next next;
  first_vertices(c, next);
  OwnSlot own = OwnSlot(true, true, false, 0.0);
  int last = next.away[unseen] != kNever ? 0 : -1;
  if (!is_over(next)) {
    do {
      const int i = nearest_walk(next);
      int at = next.at[0];
      for (int k = 1; k < kWalks; k++) at = k == i ? next.at[k] : at;
      const Stop stop = stop_at(at);
      const bool is_unseen = kUnseen != 0u && i == unseen, is_in_own = i == c.slot;
      const bool is_parted = is_in_own && own.is_own && is_apart(stop, search);
      const bool begins = begins_run(stop, search) || is_parted;
      Twin twin = Twin(false, false);
      if (kUnseen != 0u && !is_unseen) twin = twin_of(next, search, stop);
      const int unseen_at = next.at[unseen];
      const Corner corner = corner_of(c, stop, twin.goes_on ? unseen_at : at, begins);
      Walk walk = walk_of_slot(own, c, stop, corner.place, is_in_own, begins, is_parted);
      Stroke stroke = stroke_to(corner.place, walk, begins, abs(stop.step - search.from));
      if (begins && !is_parted) close_solid(walk, stroke, c, stop);
      // What is seen of the first surfaces the slots have, and where one goes on in a slot it does not go on unseen.
      if (!is_unseen) add_stroke(found, walk, c, stroke, corner, begins, stop.goes_on || twin.goes_on);
      if (is_unseen || twin.exists) last = unseen_at;
      go_to(next, search, i, at + search.step, ends_at(stop, corner, search));
      if (twin.exists)
        go_to(next, search, unseen, unseen_at + search.step, ends_at(stop_at(unseen_at), corner, search));
    } while (!is_over(next));
  }
  return last;
}

/// 3. to 8. What a side blocks.
BlockedArcs blocked_by(Context c) {
  const Blocked nothing = Blocked(slope_of(c.side.ahead), 0u);
  Found found = Found(nothing, nothing);
  int last;
  if (kWalks == 1)
    last = walk_along(found, c);
  else
    last = walk_along_all(found, c);
  add_beyond(found, c, last);
  if (kGoesBeyond) add_border(found, c);
  return arcs_of(c, found);
}

/// Adds one direction to the sums of the pixel's moments; the last call divides by the weight.
void add_moments(int index, int plane, mat3 blocked, float whole) {
  for (int k = 0; k < moments_in(kOrder); k++) {
    const int at = index + k * plane;
    const float sum = params.is_first == 0 ? moments[at] + moment(blocked, k) : moment(blocked, k);
    moments[at] = params.is_last != 0 ? stored_moment(whole > 0.0 ? sum / whole : 0.0) : sum;
  }
}

void main() {
  const View view = params.view;
  const Lines lines = params.lines;
  const ivec2 extent = extent_of(view, lines);
  ivec2 at = params.first + params.stride * ivec2(gl_GlobalInvocationID.xy);  // along and across
  if (kListed != 0u) {
    const ListedPlace place = listed_place(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
    if (place.tile >= counts.listed) return;
    const ivec2 origin = lines.steep != 0 ? lines.origin.yx : lines.origin;
    const ivec2 listed = pixel_of_anchored_tile(unpack_tile(list[place.tile]), place.pixel, origin);
    if (!inside(view, listed)) return;
    at = lines.steep != 0 ? listed.yx : listed;
  }
  if (at.x >= extent.x || at.y >= extent.y) return;
  const ivec2 pixel = lines.steep != 0 ? at.yx : at;
  const int index = index_of(view, pixel);
  const int pixels = view.size.x * view.size.y;
  const int ao_index = index + int(params.plane) * pixels;
  const float z = depth[index];
  if (z >= kSkyDepth) {
    ao[ao_index] = 1.0;
    for (int k = 0; k < moments_in(kOrder); k++) moments[index + k * pixels] = stored_moment(0.0);
    return;
  }
  const int line = at.y - shift_at(lines, at.x), row = row_of(lines, line, extent.y) * extent.x;
  const LinePlane plane = plane_of(view, lines, line);
  const ivec2 on_image = kGoesBeyond ? steps_of(lines, extent, line) : ivec2(0);
  const vec3 n = unpack_normal(normal[index]);
  const vec2 tangent = tangent_at(view, lines, at + lines.origin);
  const Point point = point_of(view, plane, tangent, z, n);  // 2.
  const float clearance =
      least_height(params.depth_precision, z, (view.orthographic != 0 ? 0.0 : dot(n.xy, tangent)) - n.z);
  const float weight = length(point.normal);
  const int slot = kSlots > 1u ? int(own[row + at.x]) : 0;
  float blocked = 0.0, whole = 0.0, unseen = 0.0;
  mat3 blocked_moments = mat3(0);
  const mat2x3 in_view = mat2x3(vec3(plane.along, 0), away_of(view, plane));
  if (weight >= kLeastWeight) {
    const float share = 1.0 / (plane.ray_length * -point.eye.y);  // 1.
    int sign = -1;
    do {
      const Side side = side_of(point, weight, sign);
      const Search search = search_of(view, point, side, weight, clearance, z, at.x, sign);
      whole += share * weight * whole_arc(side);
      const Context c =
          Context(view, lines, line, on_image, z, plane, point, side, search, row, slot, params.radius * params.radius);
      const BlockedArcs arcs = blocked_by(c);
      blocked += share * weight * arcs.arc;
      unseen += share * weight * arcs.unseen;
      if (kOrder > 0u)
        blocked_moments += share * weight *
                           moments_of(mat2x3(arcs.arc, arcs.moments[0], arcs.moments[1], 0), in_view * search.across,
                                      in_view * point.eye);
      sign += 2;
    } while (sign <= 1);
  }
  const float last_whole = params.is_first == 0 ? whole_arcs[index] : 0.0;
  if (params.is_first == 0) {
    whole += last_whole;
    blocked += ao[ao_index];
  }
  whole_arcs[index] = whole;
  if (kTellsApart && whole > 0.0)
    completed[index] =
        clamp((last_whole > 0.0 ? completed[index] * last_whole : 0.0) + unseen, 0.0, max(blocked, 0.0)) / whole;
  add_moments(index, pixels, blocked_moments, whole);
  // 9.
  if (params.is_last != 0) blocked = whole > 0.0 ? clamp(1.0 - blocked / whole, 0.0, 1.0) : 1.0;
  ao[ao_index] = blocked;
}
