// The profile of the depth along every line of one direction: runs of one surface, each drawn by as few straight
// strokes as keep to its pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth; of several surfaces per pixel, where the frame has hidden ones. View normals.
// Out: for every line its vertices, one after the other from the line's first column of the sheared image (lines.glsl)
// on; and for every pixel the vertices before and after it. With several surfaces per pixel that in each of as many
// slots: a profile with gaps where the slot has no surface.
//
// The steps have their numbers at the code:
//  1. The line's depth at a step is taken between the two pixels beside it if they are one surface. Else the nearer one
//     goes on as it does on its other side: planes stay planes.
//  2. A run is a row of steps that are one surface (solids.glsl). How far back it is solid, its ends tell, each vertex
//     has for itself, and for either way that one may look along the line: by its width, by how far it is seen to go
//     back, or by a rounded outline.
//  3. Disparity 1/z (orthographic: z) along a line is to a slice through the eye what a projective map is: straight
//     stays straight. A stroke is drawn on as long as it keeps within the tolerance of all it passes ("swinging door",
//     Bristol, "Swinging Door Trending", 1990). Vertices are steps themselves.
//  4. A run has a vertex at least every kProfileRestart pixels, so that crops have the vertices of the whole.
//  5. A run keeps its slot, whichever surface of its pixel goes on with it: a floor that is the first surface before a
//     column, and the third behind its front and its back, is one run. Of several surfaces that might go on with
//     several runs, the two that are nearest to each other do. What begins takes the first slots that are free, the
//     nearest surface first.
//  6. If the next surface of a pixel is known to close a surface's solid, it tells the thickness there. A surface that
//     closes a solid has no thickness itself.
// The first surfaces of all pixels are a profile of their own besides: complete.comp finds in it what goes on behind
// others.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/exact.h"
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/lines.glsl"
#include "kernels/estimate/solids.glsl"

layout(local_size_x = kProfileGroup) in;
layout(constant_id = 0) const uint kEveryPixel = 0;  // 1: every pixel is a vertex
layout(constant_id = 1) const uint kSurfaces = 1;    // of a pixel, 1 to 1 + kMostHidden
layout(constant_id = 2) const uint kSlots = 1;       // as many as surfaces; or 1 for the first surface of each pixel
layout(scalar, push_constant) uniform Push { ProfileParams params; };
readonly buffer Depth { float depth[]; };  // one float per pixel, depth of the first surfaces that may block
// What comes out has a plane of the image's size for each slot.
buffer Vertex { float vertex[]; };  // one float per vertex, its planar depth
// one uint per vertex: its step in the high half and kVertex* in the low; 0 for a line that shows no surface
buffer Mark { uint mark[]; };
// one uint per vertex: how far back it is solid (pack_thickness()); 0: not known
buffer Solid { uint solid[]; };
// one uint per step: the columns of the vertices before (low half) and after it; kNoVertex: none
writeonly buffer Neighbor { uint neighbor[]; };
readonly buffer Normal { uint normal[]; };   // one uint per pixel, from prepare; only with params.solids
readonly buffer Hidden { float hidden[]; };  // planes of floats, see GBuffer::hidden; only with several surfaces
// one uint per step, the slot of its first surface, as many as there are slots if that may not block; only with
// several slots
writeonly buffer Own { uint own[]; };

/// Three pixels across a line whose values change by amounts that differ by less than this part are one surface however
/// steep it is, as a floor seen aslant.
const float kStraight = 0.25;

/// Beside a pixel near the horizon a plane may go on behind it: then this part of the pixel's disparity stands for it.
const float kLeastNearness = 0.02;

const float kFar = 1e30;

/// The known thickness of what has none: marks hold 0 where a thickness is not known.
const float kNoThickness = 1e-30;

/// The known thickness of a run may be off the straight line between two vertices by this part of it.
const float kThicknessTolerance = 0.05;

/// The surface at one step of a line.
struct Step {
  int at;  // the step
  bool is_surface;
  bool is_first;  // the first surface of its pixel
  float z;        // planar depth on the line itself
  float value;    // value_of() it
  vec2 place;     // in the plane of the line
  float known;    // scene units: how thick the surface's solid is here, along the eye's ray; below 0: not known
};

/// A line's profile so far, and the run that its last step is in.
struct Run {
  int row, begin;      // of the line in the sheared image: the index of its column 0; its first column
  int next;            // column of the next vertex
  bool is_open;        // whether the last step is in a run
  bool is_pending;     // whether the last step is in it without being a vertex
  int first;           // column of the run's first vertex
  int anchor;          // step of the last vertex
  float anchor_value;  // value_of() it
  float low, high;     // slopes of the strokes from the last vertex that keep to all steps since
  int filled;          // step up to which steps know their neighbors
  // Only with several slots:
  float anchor_known;        // the thickness known at the last vertex
  float thinnest, thickest;  // changes of it per step, that keep to all steps since
};

/// Whether two depths tell one surface.
bool connected(bool perspective, float pixel, float a, float b) {
  return abs(a - b) < kRunSlope * pixel * (perspective ? min(a, b) : 1.0);
}

/// The signed depth of a surface of a pixel; sky, where it has fewer.
float surface_at(View view, int index, uint k) {
  return k == 0u ? depth[index] : hidden[int(k - 1u) * view.size.x * view.size.y + index];
}

/// The depth of a pixel's surface that goes on from one of depth z: the nearest to it that does, else the first.
float depth_like(View view, int index, float z) {
  if (kSurfaces == 1u) return depth[index];
  float best = depth[index];
  for (uint k = 1u; k < kSurfaces; k++) {
    const float other = abs(surface_at(view, index, k));
    const bool is_nearer =
        connected(view.orthographic == 0, view.tangent_per_pixel.x, other, z) && abs(other - z) < abs(best - z);
    best = is_nearer ? other : best;
  }
  return best;
}

/// 6. How thick the solid of a pixel's surface of depth z is known to be, along the eye's ray at a step of the line.
float known_thickness(View view, LinePlane plane, int step, int index, uint k, float z) {
  if (kSurfaces == 1u) return -1.0;
  const float next = k + 1u < kSurfaces ? surface_at(view, index, k + 1u) : kSkyDepth;
  const vec2 through = place_at(view, plane, float(step), abs(next)) - place_at(view, plane, float(step), z);
  const float known = next < 0.0 ? max(length(through), kNoThickness) : -1.0;
  return surface_at(view, index, k) < 0.0 ? kNoThickness : known;
}

/// The first surface of a pixel, by its place along and across.
Facet facet_of(View view, Lines lines, ivec2 at) {
  const int index = index_at(view, lines, at.x, at.y);
  const vec2 tangent = tangent_at(view, lines, at + lines.origin);
  const float z = depth[index];
  const vec3 position = view.orthographic == 0 ? z * vec3(tangent, -1) : vec3(tangent, -z);
  return Facet(position, unpack_normal(normal[index]), z);
}

/// That of the pixel at a step of a line.
Facet facet_at(View view, Lines lines, int line, int step) {
  return facet_of(view, lines, ivec2(step, line + shift_at(lines, step)));
}

/// Whether two pixels beside each other across a line, whose surfaces have these depths, show one: a plane may be so
/// steep that depth alone tells them apart.
bool connected_across(View view, Lines lines, int column, int a, int b, float z, float other) {
  if (connected(view.orthographic == 0, view.tangent_per_pixel.x, z, other)) return true;
  if (params.solids == 0u) return false;
  const Facet here = facet_of(view, lines, ivec2(column, a)), beside = facet_of(view, lines, ivec2(column, b));
  return here.z == z && beside.z == other && are_coplanar(view, here, beside, kPlaneDot, kPlaneOff);
}

uint columns(int before, int after) { return uint(before) & kNoVertex | uint(after) << 16; }

/// The value's change from the pixel `across` to the next one on a side, by the pixels on the other side: `known` says
/// whether there is a next one that is no sky, whose value lies `ahead`. At the image's border, where the pixel before
/// is missing, the one after the next stands for it.
float change_behind(View view, Lines lines, int rows, int column, int across, int side, float nearest, float other,
                    bool known) {
  const bool perspective = view.orthographic == 0;
  const float here = value_of(perspective, nearest), ahead = value_of(perspective, other) - here;
  const bool first = uint(across - side) >= uint(rows);
  const int back = clamp(known || first ? across - side : across - 2 * side, 0, rows - 1);
  const float third = depth_like(view, index_at(view, lines, column, clamp(across - side, 0, rows - 1)), nearest);
  const float behind = here - value_of(perspective, third);
  const int beyond = first ? clamp(across + 2 * side, 0, rows - 1) : back;
  const float fourth = depth_like(view, index_at(view, lines, column, beyond), third);
  float next_to = value_of(perspective, third) - value_of(perspective, fourth);
  if (known) next_to = behind;
  if (first) next_to = value_of(perspective, fourth) - value_of(perspective, other);
  const float straight = known ? ahead : behind;
  const int opposite = clamp(across - side, 0, rows - 1);
  const float bent = connected_across(view, lines, column, across, opposite, nearest, third) ? behind : 0.0;
  return abs(straight - next_to) < kStraight * abs(straight) ? straight : bent;
}

/// 1. How much the value changes from the pixel that a line passes to the next one on the side where the line lies.
float change_across(View view, Lines lines, int rows, int column, int across, int side, float nearest, uint surface) {
  const bool perspective = view.orthographic == 0;
  const int beside = clamp(across + side, 0, rows - 1), opposite = clamp(across - side, 0, rows - 1);
  if (kSurfaces > 1u) {
    // What is seen aslant goes on straight, though a hidden surface of the next pixel may be nearer to it in depth.
    const float own = abs(surface_at(view, index_at(view, lines, column, beside), surface));
    const float back = abs(surface_at(view, index_at(view, lines, column, opposite), surface));
    const float here = value_of(perspective, nearest), ahead = value_of(perspective, own) - here;
    const bool is_inside = beside != across && opposite != across;
    const bool is_straight = abs(ahead - here + value_of(perspective, back)) < kStraight * abs(ahead);
    if (is_inside && is_straight && max(max(nearest, own), back) < kSkyDepth) return ahead;
  }
  const float other = depth_like(view, index_at(view, lines, column, beside), nearest);
  const bool known = other < kSkyDepth && beside != across;
  const bool same = known && connected_across(view, lines, column, across, beside, nearest, other);
  float change = same ? value_of(perspective, other) - value_of(perspective, nearest) : 0.0;
  if (!same && nearest < kSkyDepth)
    change = change_behind(view, lines, rows, column, across, side, nearest, other, known);
  return change;
}

/// A surface at a step of the line; at `end`, behind its last step, there is none.
Step step_at(View view, Lines lines, LinePlane plane, int rows, int line, int at, int end, uint surface) {
  const bool perspective = view.orthographic == 0;
  const int column = min(at, end - 1), across = line + shift_at(lines, column);
  const float rest = rest_at(lines, column);
  const int index = index_at(view, lines, column, across);
  const float nearest = abs(surface_at(view, index, surface));
  const float here = value_of(perspective, nearest);
  const float change = change_across(view, lines, rows, column, across, rest < 0.0 ? -1 : 1, nearest, surface);
  const float between = here + abs(rest) * change;
  Step s;
  s.at = at;
  s.is_surface = nearest < kSkyDepth && at < end;
  s.is_first = surface == 0u;
  s.value = perspective ? max(between, kLeastNearness * here) : between;
  s.z = value_of(perspective, s.value);
  s.place = place_at(view, plane, float(at), s.z);
  s.known = known_thickness(view, plane, column, index, surface, nearest);
  return s;
}

/// How the surfaces of two neighbouring steps hang together.
struct Link {
  bool is_one;    // surface
  bool is_apart;  // yet the receiver's own surface is not sure to go on
};

/// Whether the normals of two neighbouring steps, the second is `step`, tell that they are one surface, however far
/// apart they are in depth.
bool is_one_by_normals(View view, Lines lines, ivec2 steps, int line, int step, Facet a, Facet b) {
  if (are_coplanar(view, a, b, kPlaneDot, kPlaneOff)) return true;
  const bool recedes = b.z > a.z;
  const int next = recedes ? step + 1 : step - 2;
  Facet beyond = b;
  beyond.z = kSkyDepth;
  if (next >= steps.x && next < steps.y) beyond = facet_at(view, lines, line, next);
  const ivec2 onward = ivec2(1, shift_at(lines, step) - shift_at(lines, step - 1));
  const vec2 on_image = vec2(lines.steep != 0u ? onward.yx : onward);
  if (recedes) return meet_at_edge(view, b, a, beyond, -on_image);
  return meet_at_edge(view, a, b, beyond, on_image);
}

Link link_of(View view, Lines lines, ivec2 steps, int line, Step last, Step here) {
  const bool perspective = view.orthographic == 0;
  const float nearer = perspective ? min(here.z, last.z) : 1.0;
  const float apart = abs(here.z - last.z), pixel = view.tangent_per_pixel.x * nearer;
  const bool exists = here.is_surface && last.is_surface;
  Link link = Link(exists && apart < kRunSlope * pixel, false);
  const bool has_normals = params.solids != 0u && exists && here.is_first && last.is_first;
  // Faces that are nearer together than that are not parallel ones before each other.
  const vec2 along = here.place - last.place;
  const float nearest = kParallelApart * params.radius;
  const bool may_be_parallel = apart > kParallelSlope * pixel && dot(along, along) > nearest * nearest;
  if (has_normals && (may_be_parallel || apart >= kOwnSlope * pixel)) {
    const Facet a = facet_at(view, lines, line, here.at - 1), b = facet_at(view, lines, line, here.at);
    const bool by_depth = link.is_one && !(may_be_parallel && are_parallel(view, a, b, params.radius));
    const bool by_normals = apart >= kOwnSlope * pixel && is_one_by_normals(view, lines, steps, line, here.at, a, b);
    link.is_one = apart < kRunSlope * pixel ? by_depth : by_normals;
    link.is_apart = link.is_one && apart >= kOwnSlope * pixel && !by_normals;
  }
  return link;
}

/// 3. Puts a vertex at a step; strokes go on from it.
void emit_vertex(inout Run run, Step s) {
  vertex[run.row + run.next] = s.z;
  mark[run.row + run.next] = uint(s.at) << 16 | (s.is_first ? 0u : kVertexHidden);
  solid[run.row + run.next] = s.known < 0.0 ? 0u : pack_thickness(s.known, s.known);
  neighbor[run.row + s.at] = columns(run.next == run.begin ? -1 : run.next - 1, run.next + 1);
  run.anchor = s.at;
  run.anchor_value = s.value;
  run.low = -kFar;
  run.high = kFar;
  run.anchor_known = s.known;
  run.thinnest = -kFar;
  run.thickest = kFar;
  run.next++;
}

/// A vertex, once its run is closed.
struct Corner {
  int index, step;
  uint marked;
  float z;
  vec2 place;
};

Corner corner_at(View view, LinePlane plane, int index) {
  const uint marked = mark[index];
  const int step = int(marked >> 16);
  const float z = vertex[index];
  return Corner(index, step, marked, z, place_at(view, plane, float(step), z));
}

/// One end of a run, as one sees it who looks at it from beyond that end.
struct End {
  vec2 place;
  float pixel;
  bool is_cut;  // by the image's border
  bool is_flat;
  bool is_round;  // the solid's back mirrors its front
  bool closes;    // a hidden face goes back from it
};

/// The end of a run at a corner, from which it goes on `inward` (1 or -1) for `count` steps in all.
End end_of(View view, Lines lines, LinePlane plane, ivec2 steps, int line, Corner corner, int inward, int count) {
  const int at = corner.step, last = steps.y - 1, before = at - inward;
  End end = End(corner.place, pixel_width(view, corner.z), at == (inward > 0 ? steps.x : last), false, false, false);
  const Facet a = facet_at(view, lines, line, at);
  const Facet b = facet_at(view, lines, line, clamp(at + inward, steps.x, last));
  const Facet c = facet_at(view, lines, line, clamp(at + 2 * inward, steps.x, last));
  const bool is_known = params.solids != 0u && (corner.marked & kVertexHidden) == 0u && count > 2;
  const int hidden_at = clamp(before, steps.x, last);
  const float deeper = depth[index_at(view, lines, hidden_at, line + shift_at(lines, hidden_at))];
  const bool hides = is_known && before == hidden_at && deeper > a.z;
  const vec2 away = view.orthographic == 0 ? normalize(corner.place) : vec2(0, 1);
  const bool grazes = -dot(in_plane(view, plane, a.normal), away) < kRoundFacing;
  end.is_flat = is_known && are_flat(view, a, b, c);
  end.is_round = hides && grazes && count >= kRoundPixels && dot(a.normal, c.normal) < kRoundDot;
  end.closes = hides && min(dot(a.normal, b.normal), dot(a.normal, c.normal)) >= kClosingDot;
  return end;
}

/// 2. How thick a run is by its width, in scene units, where one sees it from beyond one of its ends. is_cut: the
/// image's border cuts it, so that its width is not known, at an end that is flat or not.
float thickness_by_width(float width, float pixel, bool is_flat, bool is_cut, bool is_cut_flat) {
  const float widest = (is_flat ? 2.0 : 1.0) * params.widest;
  const float thickness = levelled(params.depth_per_width * width + params.more_pixels * pixel, widest);
  return is_cut ? max(thickness, (is_cut_flat ? 2.0 : 1.0) * params.least_at_border) : thickness;
}

/// How far a surface at a place is seen to go back, by another place of its run: farther from the eye, and behind its
/// own plane.
float back_at(View view, vec2 place, vec2 n, vec2 other) {
  const bool perspective = view.orthographic == 0;
  const float farther = perspective ? length(other) - length(place) : other.y - place.y;
  return min(farther, -dot(n, other - place));
}

/// The same beyond one end, at a vertex.
float thickness_at(View view, float by_width, float by_back, End end, vec2 place) {
  const bool perspective = view.orthographic == 0;
  const float before = perspective ? length(end.place) - length(place) : end.place.y - place.y;
  const float mirrored = max(min(2.0 * before, kMostBack * params.radius), end.pixel);
  return end.is_round ? mirrored : max(by_width, by_back);
}

/// Of a run, as one sees it from beyond either end.
struct Solidity {
  End first, last;
  vec2 by_width;  // thickness
  bool reaches;   // how far back it is seen to go tells, too
};

Solidity solidity_of(View view, Lines lines, LinePlane plane, ivec2 steps, int line, Corner first, Corner last) {
  const int count = last.step - first.step + 1;
  Solidity s;
  s.first = end_of(view, lines, plane, steps, line, first, 1, count);
  s.last = end_of(view, lines, plane, steps, line, last, -1, count);
  const float pixel = min(s.first.pixel, s.last.pixel), width = length(last.place - first.place) + pixel;
  const bool is_cut = s.first.is_cut || s.last.is_cut;
  const bool is_cut_flat = s.first.is_cut && s.first.is_flat || s.last.is_cut && s.last.is_flat;
  s.by_width = vec2(thickness_by_width(width, pixel, s.first.is_flat, is_cut, is_cut_flat),
                    thickness_by_width(width, pixel, s.last.is_flat, is_cut, is_cut_flat));
  s.reaches = params.solids != 0u && count > 1 && params.depth_per_width * width < 2.0 * params.widest;
  return s;
}

/// How far back a run is solid at a corner.
uint thickness_of(View view, Lines lines, LinePlane plane, int line, Solidity s, Corner corner) {
  const int pixel = index_at(view, lines, corner.step, line + shift_at(lines, corner.step));
  const vec2 n = in_plane(view, plane, unpack_normal(normal[pixel]));
  const float seen = max(back_at(view, corner.place, n, s.first.place), back_at(view, corner.place, n, s.last.place));
  const bool reaches = s.reaches && (corner.marked & kVertexHidden) == 0u;
  const float back = reaches ? clamp(seen, 0.0, kMostBack * params.radius) : 0.0;
  return pack_thickness(thickness_at(view, s.by_width.x, back, s.first, corner.place),
                        thickness_at(view, s.by_width.y, back, s.last, corner.place));
}

/// The same of the part of a run from a corner on.
uint thickness_of_part(View view, Solidity s, Corner corner) {
  const float pixel = pixel_width(view, corner.z);
  const vec2 widths = vec2(length(s.last.place - corner.place), length(s.first.place - corner.place)) + pixel;
  return pack_thickness(thickness_by_width(widths.x, pixel, false, s.last.is_cut, false),
                        thickness_by_width(widths.y, pixel, false, s.first.is_cut, false));
}

/// 2. Gives all vertices of a slot's profile their thickness, where it is not known. This follows the profile, since a
/// driver may take its time for all steps though few end a run.
void thicken(Run run, View view, Lines lines, LinePlane plane, ivec2 steps, int line) {
  Solidity s;
  int column = run.begin;
  if (column < run.next) do {
      const Corner corner = corner_at(view, plane, run.row + column);
      if ((corner.marked & kVertexBegins) != 0u) {
        int last = corner.index;
        while ((mark[last] & kVertexEnds) == 0u) last++;
        s = solidity_of(view, lines, plane, steps, line, corner, corner_at(view, plane, last));
        mark[corner.index] |= s.first.closes ? kVertexCloses : 0u;
        mark[last] |= s.last.closes ? kVertexClosesAgainst : 0u;
      }
      const uint whole = thickness_of(view, lines, plane, line, s, corner), part = thickness_of_part(view, s, corner);
      const uint along = (corner.marked & kVertexApart) != 0u ? part : whole;
      const uint against = (corner.marked & kVertexApartAgainst) != 0u ? part : whole;
      if (solid[corner.index] == 0u) solid[corner.index] = along & 0xffffu | against & ~0xffffu;
    } while (++column < run.next);
}

/// Marks the first and the last vertex of a run that ends.
void close_run(inout Run run) {
  mark[run.row + run.first] |= kVertexBegins | (run.first == run.begin ? kVertexFirst : 0u);
  mark[run.row + run.next - 1] |= kVertexEnds;
  run.is_open = false;
}

/// Tells the steps up to `end` that show no surface of the slot the vertices before and after them.
void fill(inout Run run, int end, int after) {
  const int before = run.next == run.begin ? -1 : run.next - 1;
  int step = run.filled;
  if (step < end) do
      neighbor[run.row + step] = columns(before, after);
    while (++step < end);
  run.filled = end;
}

void begin_run(inout Run run, Step start) {
  fill(run, start.at, run.next);
  run.first = run.next;
  run.is_open = true;
  emit_vertex(run, start);
}

/// Whether what is known of the thickness at a step leaves it on the stroke from the last vertex.
bool fits_thickness(Run run, Step here) {
  const float change = (here.known - run.anchor_known) / float(here.at - run.anchor);
  return here.known < 0.0 ? run.anchor_known < 0.0
                          : run.anchor_known >= 0.0 && change >= run.thinnest && change <= run.thickest;
}

/// Ends the receiver's own run between the last vertex and a step of it, which becomes the next one.
void part_own(inout Run run, Step here) {
  mark[run.row + run.next - 1] |= kVertexApartAgainst;
  emit_vertex(run, here);
  mark[run.row + run.next - 1] |= kVertexApart;
}

/// 2. to 4. Draws a slot's profile on to its next step.
void draw(inout Run run, View view, Lines lines, LinePlane plane, ivec2 steps, int line, Step last, Step here) {
  const bool perspective = view.orthographic == 0;
  const float pixel = view.tangent_per_pixel.x, tolerance = params.tolerance * pixel;
  const int t = here.at;
  Link link = Link(false, false);
  if (run.is_open) link = link_of(view, lines, steps, line, last, here);
  const bool goes_on = link.is_one;
  const float slope = (here.value - run.anchor_value) / float(t - run.anchor);
  const bool fits = goes_on && !link.is_apart && kEveryPixel == 0u && slope >= run.low && slope <= run.high &&
                    (kSurfaces == 1u || fits_thickness(run, here)) &&
                    ((t - 1 + lines.origin.x) & (kProfileRestart - 1)) != 0;
  if (run.is_pending && !fits) {
    emit_vertex(run, last);
    run.is_pending = false;
  }
  if (run.is_open && !goes_on) close_run(run);
  if (here.is_surface && !goes_on) begin_run(run, here);
  if (goes_on) {
    const float reach = tolerance * (perspective ? here.value : 1.0);
    const float length_px = float(t - run.anchor);
    neighbor[run.row + t] = columns(run.next - 1, run.next);
    run.low = max(run.low, (here.value - reach - run.anchor_value) / length_px);
    run.high = min(run.high, (here.value + reach - run.anchor_value) / length_px);
    if (kSurfaces > 1u) {
      const float may_be_off = kThicknessTolerance * here.known;
      run.thinnest = max(run.thinnest, (here.known - may_be_off - run.anchor_known) / length_px);
      run.thickest = min(run.thickest, (here.known + may_be_off - run.anchor_known) / length_px);
    }
    run.is_pending = !link.is_apart;
  }
  if (link.is_apart) part_own(run, here);
  if (here.is_surface) run.filled = t + 1;
}

/// Ends a slot's profile with its line.
void finish(inout Run run, ivec2 steps) {
  if (run.next > run.begin) {
    mark[run.row + run.next - 1] |= kVertexLast;
    neighbor[run.row + run.anchor] = columns(run.next - 1 == run.begin ? -1 : run.next - 2, -1);
  } else if (steps.x < steps.y) {
    mark[run.row + run.begin] = 0u;
  }
  fill(run, steps.y, -1);
}

/// 5. The surfaces of a step in their slots: `here` has a step of each slot, which is without a surface. Returns the
/// slot of the first surface, kSlots where it is none. No choice depends on the slots' numbers: a crop has others.
uint share_out(View view, Lines lines, ivec2 steps, int line, Run runs[kSlots], Step lasts[kSlots],
               Step surfaces[kSlots], inout Step here[kSlots]) {
  uint slots = 0u, shared_out = 0u, own_slot = kSlots;
  for (uint round = 0u; round < kSlots; round++) {
    float least = kFar, last = kFar;
    uint best_slot = kSlots, best = kSlots;
    for (uint slot = 0u; slot < kSlots; slot++) {
      for (uint k = 0u; k < kSlots; k++) {
        const bool is_free = ((slots >> slot | shared_out >> k) & 1u) == 0u;
        const float apart = abs(surfaces[k].z - lasts[slot].z);
        const bool is_nearer = apart < least || apart == least && lasts[slot].z < last;
        bool is_better = is_free && runs[slot].is_open && is_nearer;
        if (is_better) is_better = link_of(view, lines, steps, line, lasts[slot], surfaces[k]).is_one;
        least = is_better ? apart : least;
        last = is_better ? lasts[slot].z : last;
        best_slot = is_better ? slot : best_slot;
        best = is_better ? k : best;
      }
    }
    if (best < kSlots) {
      here[best_slot] = surfaces[best];
      slots |= 1u << best_slot;
      shared_out |= 1u << best;
      own_slot = best == 0u ? best_slot : own_slot;
    }
  }
  for (uint k = 0u; k < kSlots; k++) {
    const uint slot = uint(findLSB(~slots));
    if (surfaces[k].is_surface && (shared_out >> k & 1u) == 0u) {
      here[slot] = surfaces[k];
      slots |= 1u << slot;
      own_slot = k == 0u ? slot : own_slot;
    }
  }
  return own_slot;
}

void main() {
  if (gl_GlobalInvocationID.x >= params.count) return;
  const View view = params.view;
  const Lines lines = params.lines;
  const ivec2 extent = extent_of(view, lines);
  const int line = params.first + int(gl_GlobalInvocationID.x);
  const LinePlane plane = plane_of(view, lines, line);
  const ivec2 steps = steps_of(lines, extent, line);
  const int row = row_of(lines, line, extent.y) * extent.x;
  const Step none = Step(0, false, false, 1.0, 0.0, vec2(0), -1.0);
  Step lasts[kSlots];
  Run runs[kSlots];
  for (uint slot = 0u; slot < kSlots; slot++) {
    lasts[slot] = none;
    const int first = int(params.slot + slot) * extent.x * extent.y + row;
    runs[slot] = Run(first, steps.x, steps.x, false, false, steps.x, 0, 0.0, 0.0, 0.0, steps.x, -1.0, 0.0, 0.0);
  }
  int t = steps.x;
  do {
    Step here[kSlots];
    here[0] = step_at(view, lines, plane, extent.y, line, t, steps.y, 0u);
    if (kSlots > 1u) {
      Step surfaces[kSlots];
      surfaces[0] = here[0];
      bool goes = true;  // the first one may be no occluder
      for (uint k = 1u; k < kSlots; k++) {
        surfaces[k] = none;
        if (goes) surfaces[k] = step_at(view, lines, plane, extent.y, line, t, steps.y, k);
        goes = surfaces[k].is_surface;
      }
      for (uint slot = 0u; slot < kSlots; slot++) {
        here[slot] = none;
        here[slot].at = t;
      }
      const uint own_slot = share_out(view, lines, steps, line, runs, lasts, surfaces, here);
      if (t < steps.y) own[row + t] = own_slot;
    }
    for (uint slot = 0u; slot < kSlots; slot++) {
      draw(runs[slot], view, lines, plane, steps, line, lasts[slot], here[slot]);
      lasts[slot] = here[slot];
    }
  } while (++t <= steps.y);
  for (uint slot = 0u; slot < kSlots; slot++) {
    finish(runs[slot], steps);
    if (params.solids != 0u || kSurfaces > 1u) thicken(runs[slot], view, lines, plane, steps, line);
  }
}
