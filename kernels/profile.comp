// The profile of the depth along every line of one direction: runs of one surface, each drawn by as few straight
// strokes as keep to its pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth.
// Out: for every line its vertices, one after the other from the line's first column of the sheared image (lines.glsl)
// on; and for every pixel the vertices before and after it.
//
// - The line's depth at a step is taken between the two pixels beside it where they are one surface. Else the nearer
//   one goes on as it does on its other side: planes stay planes.
// - A run is a row of steps whose depths go on from each other. Its width, from outer edge to outer edge, is known at
//   both its ends.
// - Disparity 1/z (orthographic: z) along a line is to a slice through the eye what a projective map is: straight stays
//   straight. A stroke is drawn on as long as it keeps within the tolerance of all it passes ("swinging door", Bristol,
//   "Swinging Door Trending", 1990). Vertices are steps themselves.
// - A run has a vertex at least every kProfileRestart pixels, so that crops have the vertices of the whole.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "profile.h"
#include "view.glsl"
#include "arcs.glsl"
#include "bent.glsl"
#include "clearance.glsl"
#include "slice.glsl"
#include "lines.glsl"

layout(local_size_x = kProfileGroup) in;
layout(constant_id = kProfileEveryPixelId) const uint kEveryPixel = 0;
layout(scalar, push_constant) uniform Push { ProfileParams params; };
layout(scalar, binding = kProfileDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kProfileVertex) writeonly buffer Vertex { float vertex[]; };
layout(scalar, binding = kProfileMark) writeonly buffer Mark { uint mark[]; };
layout(scalar, binding = kProfileNeighbor) writeonly buffer Neighbor { uint neighbor[]; };

/// Three pixels across a line whose values change by amounts that differ by less than this part are one surface however
/// steep it is, as a floor seen aslant.
const float kStraight = 0.25;

/// Beside a pixel near the horizon a plane may go on behind it: then this part of the pixel's disparity stands for it.
const float kLeastNearness = 0.02;

const float kFar = 1e30;

/// What is seen at one step of a line.
struct Step {
  int at;  // the step
  bool is_surface;
  float z;      // planar depth on the line itself
  float value;  // value_of() it
  vec2 place;   // in the plane of the line
};

/// What is drawn of a line so far, and the run that its last step is in.
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
};

bool connected(bool perspective, float pixel, float a, float b) {
  return abs(a - b) < kRunSlope * pixel * (perspective ? min(a, b) : 1.0);
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
  const float third = depth[index_at(view, lines, column, clamp(across - side, 0, rows - 1))];
  const float behind = here - value_of(perspective, third);
  const float fourth = depth[index_at(view, lines, column, first ? clamp(across + 2 * side, 0, rows - 1) : back)];
  float next_to = value_of(perspective, third) - value_of(perspective, fourth);
  if (known) next_to = behind;
  if (first) next_to = value_of(perspective, fourth) - value_of(perspective, other);
  const float straight = known ? ahead : behind;
  const float bent = connected(perspective, view.tangent_per_pixel.x, nearest, third) ? behind : 0.0;
  return abs(straight - next_to) < kStraight * abs(straight) ? straight : bent;
}

/// How much the value changes from the pixel that a line passes to the next one on the side where the line lies.
float change_across(View view, Lines lines, int rows, int column, int across, int side, float nearest) {
  const bool perspective = view.orthographic == 0;
  const int beside = clamp(across + side, 0, rows - 1);
  const float other = depth[index_at(view, lines, column, beside)];
  const bool known = other < kSkyDepth && beside != across;
  const bool same = known && connected(perspective, view.tangent_per_pixel.x, nearest, other);
  float change = same ? value_of(perspective, other) - value_of(perspective, nearest) : 0.0;
  for (bool once = !same && nearest < kSkyDepth; once; once = false)
    change = change_behind(view, lines, rows, column, across, side, nearest, other, known);
  return change;
}

/// What is seen at a step of the line; at `end`, behind its last step, there is no surface.
Step step_at(View view, Lines lines, LinePlane plane, int rows, int line, int at, int end) {
  const bool perspective = view.orthographic == 0;
  const int column = min(at, end - 1), across = line + shift_at(lines, column);
  const float rest = rest_at(lines, column);
  const float nearest = depth[index_at(view, lines, column, across)];
  const float here = value_of(perspective, nearest);
  const float change = change_across(view, lines, rows, column, across, rest < 0.0 ? -1 : 1, nearest);
  const float between = here + abs(rest) * change;
  Step s;
  s.at = at;
  s.is_surface = nearest < kSkyDepth && at < end;
  s.value = perspective ? max(between, kLeastNearness * here) : between;
  s.z = value_of(perspective, s.value);
  s.place = place_at(view, plane, float(at), s.z);
  return s;
}

/// Puts a vertex at a step; strokes go on from it.
void emit_vertex(inout Run run, int at, float z, float value) {
  vertex[run.row + run.next] = z;
  neighbor[run.row + at] = columns(run.next == run.begin ? -1 : run.next - 1, run.next + 1);
  run.anchor = at;
  run.anchor_value = value;
  run.low = -kFar;
  run.high = kFar;
  run.next++;
}

/// Marks the first and the last vertex of a run that ends at its step `last`, the last that has a vertex.
void close_run(inout Run run, Step last, float thickness) {
  const uint packed = pack_width(thickness);
  const bool is_one = run.first == run.next - 1;
  mark[run.row + run.first] = uint(run.start.at) << 16 | packed | kVertexBegins | (is_one ? kVertexEnds : 0u) |
                              (run.first == run.begin ? kVertexFirst : 0u);
  run.last_mark = uint(last.at) << 16 | packed | kVertexEnds | (is_one ? kVertexBegins : 0u) |
                  (run.next - 1 == run.begin ? kVertexFirst : 0u);
  mark[run.row + run.next - 1] = run.last_mark;
  run.is_open = false;
}

/// How thick a run is, in scene units. The width of one that the image's border cuts is not known.
float thickness_of(View view, LinePlane plane, ivec2 steps, Step first, Step last) {
  const float nearer = view.orthographic == 0 ? min(last.z, first.place.y / plane.ray_length) : 1.0;
  const float pixel = view.tangent_per_pixel.x * nearer;
  const float width = length(last.place - first.place) + pixel;
  const bool is_cut = first.at == steps.x || last.at == steps.y - 1;
  const float thickness = params.depth_per_width * width + params.more_pixels * pixel;
  return is_cut ? max(thickness, params.least_at_border) : thickness;
}

void begin_run(inout Run run, Step start) {
  run.first = run.next;
  run.start = start;
  run.is_open = true;
  emit_vertex(run, start.at, start.z, start.value);
}

void main() {
  if (gl_GlobalInvocationID.x >= params.count) return;
  const View view = params.view;
  const Lines lines = params.lines;
  const bool perspective = view.orthographic == 0;
  const ivec2 extent = extent_of(view, lines);
  const int line = params.first + int(gl_GlobalInvocationID.x);
  const LinePlane plane = plane_of(view, lines, line);
  const float pixel = view.tangent_per_pixel.x, tolerance = params.tolerance * pixel;
  const ivec2 steps = steps_of(lines, extent, line);
  Step last = Step(0, false, 1.0, 0.0, vec2(0));
  Run run = Run(row_of(lines, line, extent.y) * extent.x, steps.x, steps.x, false, false, steps.x, last, 0, 0.0, 0.0,
                0.0, 0u);
  for (int t = steps.x; t <= steps.y; t++) {
    const Step here = step_at(view, lines, plane, extent.y, line, t, steps.y);
    const bool goes_on = run.is_open && here.is_surface && connected(perspective, pixel, here.z, last.z);
    const float slope = (here.value - run.anchor_value) / float(t - run.anchor);
    const bool fits = goes_on && kEveryPixel == 0u && slope >= run.low && slope <= run.high &&
                      ((t - 1 + lines.origin.x) & (kProfileRestart - 1)) != 0;
    for (bool once = run.is_pending && !fits; once; once = false) {
      mark[run.row + run.next] = uint(last.at) << 16;
      emit_vertex(run, last.at, last.z, last.value);
      run.is_pending = false;
    }
    for (bool once = run.is_open && !goes_on; once; once = false)
      close_run(run, last, thickness_of(view, plane, steps, run.start, last));
    for (bool once = here.is_surface && !goes_on; once; once = false) begin_run(run, here);
    if (goes_on) {
      const float reach = tolerance * (perspective ? here.value : 1.0);
      const float length_px = float(t - run.anchor);
      neighbor[run.row + t] = columns(run.next - 1, run.next);
      run.low = max(run.low, (here.value - reach - run.anchor_value) / length_px);
      run.high = min(run.high, (here.value + reach - run.anchor_value) / length_px);
      run.is_pending = true;
    }
    last = here;
  }
  if (run.next > run.begin) {
    mark[run.row + run.next - 1] = run.last_mark | kVertexLast;
    neighbor[run.row + run.anchor] = columns(run.next - 1 == run.begin ? -1 : run.next - 2, -1);
  } else if (steps.x < steps.y) {
    mark[run.row + run.begin] = 0u;
  }
}
