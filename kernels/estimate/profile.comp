// The profile of the depth along every line of one direction: runs of one surface, each drawn by as few straight
// strokes as keep to its pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth; of several surfaces per pixel, where the frame has hidden ones.
// Out: for every line its vertices, one after the other from the line's first column of the sheared image (lines.glsl)
// on; and for every pixel the vertices before and after it. With several surfaces per pixel that in each of as many
// slots: a profile with gaps where the slot has no surface.
//
// The steps have their numbers at the code:
//  1. The line's depth at a step is taken between the two pixels beside it if they are one surface. Else the nearer one
//     goes on as it does on its other side: planes stay planes.
//  2. A run is a row of steps whose depths go on from each other. Its width, from outer edge to outer edge, is known at
//     both its ends.
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
#include "kernels/base/view.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/clearance.glsl"
#include "kernels/estimate/slice.glsl"
#include "kernels/estimate/lines.glsl"

layout(local_size_x = kProfileGroup) in;
layout(constant_id = 0) const uint kEveryPixel = 0;  // 1: every pixel is a vertex
layout(constant_id = 1) const uint kSurfaces = 1;    // of a pixel, 1 to 1 + kMostHidden
layout(constant_id = 2) const uint kSlots = 1;       // as many as surfaces; or 1 for the first surface of each pixel
layout(scalar, push_constant) uniform Push { ProfileParams params; };
readonly buffer Depth { float depth[]; };  // one float per pixel, depth of the first surfaces that may block
// What comes out has a plane of the image's size for each slot.
writeonly buffer Vertex { float vertex[]; };  // one float per vertex, its planar depth
// one uint per vertex: its step in the high half, its run's thickness (pack_width()) and kVertex* in the low; 0 for
// a line that shows no surface
buffer Mark { uint mark[]; };
// one uint per step: the columns of the vertices before (low half) and after it; kNoVertex: none
writeonly buffer Neighbor { uint neighbor[]; };
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
  float z;      // planar depth on the line itself
  float value;  // value_of() it
  vec2 place;   // in the plane of the line
  float known;  // scene units: how thick the surface's solid is here, along the eye's ray; below 0: not known
};

/// A line's profile so far, and the run that its last step is in.
struct Run {
  int row, begin;      // of the line in the sheared image: the index of its column 0; its first column
  int next;            // column of the next vertex
  bool is_open;        // whether the last step is in a run
  bool is_pending;     // whether the last step is in it without being a vertex
  int first;           // column of the run's first vertex
  Step start;          // the run's first step
  int anchor;          // step of the last vertex
  float anchor_value;  // value_of() it
  float low, high;     // slopes of the strokes from the last vertex that keep to all steps since
  uint last_mark;      // of the last vertex of a run that is closed
  int filled;          // step up to which steps know their neighbors
  // Only with several slots:
  float anchor_known;        // the thickness known at the last vertex
  float thinnest, thickest;  // changes of it per step, that keep to all steps since
};

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
  const float bent = connected(perspective, view.tangent_per_pixel.x, nearest, third) ? behind : 0.0;
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
  const bool same = known && connected(perspective, view.tangent_per_pixel.x, nearest, other);
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
  s.value = perspective ? max(between, kLeastNearness * here) : between;
  s.z = value_of(perspective, s.value);
  s.place = place_at(view, plane, float(at), s.z);
  s.known = known_thickness(view, plane, column, index, surface, nearest);
  return s;
}

/// The mark of a vertex that neither begins nor ends its run: without a thickness where that is not known yet.
uint mark_of(Step s) { return uint(s.at) << 16 | (s.known < 0.0 ? 0u : pack_width(s.known)); }

/// 3. Puts a vertex at a step; strokes go on from it.
void emit_vertex(inout Run run, Step s) {
  vertex[run.row + run.next] = s.z;
  mark[run.row + run.next] = mark_of(s);
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

/// The thickness of a run at one of its vertices: what is known there, else that of the run.
uint thickness_at(Run run, int column, uint packed) {
  const uint known = kSurfaces > 1u ? mark[run.row + column] & kVertexThickness : 0u;
  return known != 0u ? known : packed;
}

/// Gives all vertices of a run its thickness that know none of their own: one may look at it from within.
void thicken_run(Run run, uint packed) {
  for (int column = run.first; column < run.next; column++)
    mark[run.row + column] = mark[run.row + column] & ~kVertexThickness | thickness_at(run, column, packed);
}

/// Marks the first and the last vertex of a run that ends at its step `last`, the last that has a vertex.
void close_run(inout Run run, Step last, float thickness) {
  const uint packed = pack_width(thickness);
  if (kSurfaces > 1u) thicken_run(run, packed);
  const bool is_one = run.first == run.next - 1;
  mark[run.row + run.first] = uint(run.start.at) << 16 | thickness_at(run, run.first, packed) | kVertexBegins |
                              (is_one ? kVertexEnds : 0u) | (run.first == run.begin ? kVertexFirst : 0u);
  run.last_mark = uint(last.at) << 16 | thickness_at(run, run.next - 1, packed) | kVertexEnds |
                  (is_one ? kVertexBegins : 0u) | (run.next - 1 == run.begin ? kVertexFirst : 0u);
  mark[run.row + run.next - 1] = run.last_mark;
  run.is_open = false;
}

/// 2. How thick a run is, in scene units. The width of one that the image's border cuts is not known.
float thickness_of(View view, LinePlane plane, ivec2 steps, Step first, Step last) {
  const float nearer = view.orthographic == 0 ? min(last.z, first.place.y / plane.ray_length) : 1.0;
  const float pixel = view.tangent_per_pixel.x * nearer;
  const float width = length(last.place - first.place) + pixel;
  const bool is_cut = first.at == steps.x || last.at == steps.y - 1;
  const float thickness = levelled(params.depth_per_width * width + params.more_pixels * pixel, params.widest);
  return is_cut ? max(thickness, params.least_at_border) : thickness;
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
  run.start = start;
  run.is_open = true;
  emit_vertex(run, start);
}

/// Whether what is known of the thickness at a step leaves it on the stroke from the last vertex.
bool fits_thickness(Run run, Step here) {
  const float change = (here.known - run.anchor_known) / float(here.at - run.anchor);
  return here.known < 0.0 ? run.anchor_known < 0.0
                          : run.anchor_known >= 0.0 && change >= run.thinnest && change <= run.thickest;
}

/// 2. to 4. Draws a slot's profile on to its next step.
void draw(inout Run run, View view, Lines lines, LinePlane plane, ivec2 steps, Step last, Step here) {
  const bool perspective = view.orthographic == 0;
  const float pixel = view.tangent_per_pixel.x, tolerance = params.tolerance * pixel;
  const int t = here.at;
  const bool goes_on = run.is_open && here.is_surface && connected(perspective, pixel, here.z, last.z);
  const float slope = (here.value - run.anchor_value) / float(t - run.anchor);
  const bool fits = goes_on && kEveryPixel == 0u && slope >= run.low && slope <= run.high &&
                    (kSurfaces == 1u || fits_thickness(run, here)) &&
                    ((t - 1 + lines.origin.x) & (kProfileRestart - 1)) != 0;
  if (run.is_pending && !fits) {
    emit_vertex(run, last);
    run.is_pending = false;
  }
  if (run.is_open && !goes_on) close_run(run, last, thickness_of(view, plane, steps, run.start, last));
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
    run.is_pending = true;
  }
  if (here.is_surface) run.filled = t + 1;
}

/// Ends a slot's profile with its line.
void finish(inout Run run, ivec2 steps) {
  if (run.next > run.begin) {
    mark[run.row + run.next - 1] = run.last_mark | kVertexLast;
    neighbor[run.row + run.anchor] = columns(run.next - 1 == run.begin ? -1 : run.next - 2, -1);
  } else if (steps.x < steps.y) {
    mark[run.row + run.begin] = 0u;
  }
  fill(run, steps.y, -1);
}

/// 5. The surfaces of a step in their slots: `here` has a step of each slot, which is without a surface. Returns the
/// slot of the first surface, kSlots where it is none. No choice depends on the slots' numbers: a crop has others.
uint share_out(bool perspective, float pixel, Run runs[kSlots], Step lasts[kSlots], Step surfaces[kSlots],
               inout Step here[kSlots]) {
  uint slots = 0u, shared_out = 0u, own_slot = kSlots;
  for (uint round = 0u; round < kSlots; round++) {
    float least = kFar, last = kFar;
    uint best_slot = kSlots, best = kSlots;
    for (uint slot = 0u; slot < kSlots; slot++) {
      for (uint k = 0u; k < kSlots; k++) {
        const bool is_free = ((slots >> slot | shared_out >> k) & 1u) == 0u;
        const float apart = abs(surfaces[k].z - lasts[slot].z);
        const bool is_nearer = apart < least || apart == least && lasts[slot].z < last;
        const bool is_better = is_free && runs[slot].is_open && surfaces[k].is_surface && is_nearer &&
                               connected(perspective, pixel, surfaces[k].z, lasts[slot].z);
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
  const bool perspective = view.orthographic == 0;
  const ivec2 extent = extent_of(view, lines);
  const int line = params.first + int(gl_GlobalInvocationID.x);
  const LinePlane plane = plane_of(view, lines, line);
  const ivec2 steps = steps_of(lines, extent, line);
  const int row = row_of(lines, line, extent.y) * extent.x;
  const Step none = Step(0, false, 1.0, 0.0, vec2(0), -1.0);
  Step lasts[kSlots];
  Run runs[kSlots];
  for (uint slot = 0u; slot < kSlots; slot++) {
    lasts[slot] = none;
    const int first = int(params.slot + slot) * extent.x * extent.y + row;
    runs[slot] =
        Run(first, steps.x, steps.x, false, false, steps.x, none, 0, 0.0, 0.0, 0.0, 0u, steps.x, -1.0, 0.0, 0.0);
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
      const uint own_slot = share_out(perspective, view.tangent_per_pixel.x, runs, lasts, surfaces, here);
      if (t < steps.y) own[row + t] = own_slot;
    }
    for (uint slot = 0u; slot < kSlots; slot++) {
      draw(runs[slot], view, lines, plane, steps, lasts[slot], here[slot]);
      lasts[slot] = here[slot];
    }
  } while (++t <= steps.y);
  for (uint slot = 0u; slot < kSlots; slot++) finish(runs[slot], steps);
}
