// The profile of the depth along every line of one direction: runs of one surface, each drawn by as few straight
// strokes as keep to its pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth. Out: for every line its vertices, one after the other from the line's first column of the sheared
// image (lines.glsl) on; and for every pixel the vertices before and after it.
// - The line's depth at a step is taken between the two pixels beside it where they are one surface, else as the nearer
//   and the pixel behind that go on: planes stay planes.
// - A run is a row of steps whose depths go on from each other. Its width, from outer edge to outer edge, is known at
//   both its ends.
// - Disparity 1/z (orthographic: z) along a line is to a slice through the eye what a projective map is: straight stays
//   straight. A stroke is drawn on as long as it keeps within the tolerance of all it passes ("swinging door", Bristol,
//   "Swinging Door Trending", 1990); vertices are steps themselves.
// - One vertex every kProfileRestart pixels at the least, so that crops have the vertices of the whole.
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
/// steep: a floor seen aslant.
const float kStraight = 0.25;

/// Beside a pixel near the horizon a plane may go on behind it: then this part of the pixel's disparity stands for it.
const float kLeastNearness = 0.02;

bool connected(bool perspective, float pixel, float a, float b) {
  return abs(a - b) < kRunSlope * pixel * (perspective ? min(a, b) : 1.0);
}

/// What is straight along a line where the surface is: disparity, or orthographic depth.
float value_of(bool perspective, float z) { return perspective ? 1.0 / z : z; }

uint columns(int before, int after) { return uint(before) & kNoVertex | uint(after) << 16; }

void main() {
  if (gl_GlobalInvocationID.x >= params.count) return;
  const View view = params.view;
  const Lines lines = params.lines;
  const bool perspective = view.orthographic == 0;
  const ivec2 extent = extent_of(view, lines);
  const int line = params.first + int(gl_GlobalInvocationID.x);
  const LinePlane plane = plane_of(view, lines, line);
  const float pixel = view.tangent_per_pixel.x, tolerance = params.tolerance * pixel;

  // The steps on the image.
  const float steps_a_pixel = float(kSlopeUnit) / (lines.slope == 0 ? 1.0 : float(lines.slope));
  const float enters = (-0.5 - float(line)) * steps_a_pixel - float(lines.origin.x),
              leaves = enters + float(extent.y) * steps_a_pixel;
  int begin = clamp(int(clamp(min(enters, leaves), -1e6, 1e6)) - 2, 0, extent.x),
      end = clamp(int(clamp(max(enters, leaves), -1e6, 1e6)) + 3, 0, extent.x);
  if (lines.slope == 0) {
    begin = 0;
    end = extent.x;
  }
  while (begin < end && uint(line + shift_at(lines, begin)) >= uint(extent.y)) begin++;
  while (begin < end && uint(line + shift_at(lines, end - 1)) >= uint(extent.y)) end--;

  const int row = row_of(lines, line, extent.y) * extent.x;
  // columns of the next vertex and of the run's first; steps of that and of the last
  int next = begin, run_begins = begin, run_step = 0, anchor = 0;
  bool open = false, pending = false;  // is there a run; is the last step in it, but no vertex
  float last_z = 1.0, value = 0.0, anchor_value = 0.0, low = 0.0, high = 0.0;
  vec2 last = vec2(0), run_start = vec2(0);
  uint last_mark = 0u;
  for (int t = begin; t <= end; t++) {
    const int across = line + shift_at(lines, min(t, end - 1));
    const float rest = rest_at(lines, min(t, end - 1));
    const int side = rest < 0.0 ? -1 : 1, beside = clamp(across + side, 0, extent.y - 1);
    const float nearest = depth[index_at(view, lines, min(t, end - 1), across)],
                other = depth[index_at(view, lines, min(t, end - 1), beside)];
    const float here = value_of(perspective, nearest), ahead = value_of(perspective, other) - here;
    const bool known = other < kSkyDepth && beside != across;
    const bool same = known && connected(perspective, pixel, nearest, other);
    float change = same ? ahead : 0.0;
    for (bool looks = !same && nearest < kSkyDepth; looks; looks = false) {
      // The change before it on the same straight: at the image's border, where a pixel is missing, the one after it.
      const bool first = uint(across - side) >= uint(extent.y);
      const int column = min(t, end - 1),
                back = clamp(known || first ? across - side : across - 2 * side, 0, extent.y - 1);
      const float third = depth[index_at(view, lines, column, clamp(across - side, 0, extent.y - 1))],
                  behind = here - value_of(perspective, third);
      const float fourth =
          depth[index_at(view, lines, column, first ? clamp(across + 2 * side, 0, extent.y - 1) : back)];
      const float next_to = first   ? value_of(perspective, fourth) - value_of(perspective, other)
                            : known ? behind
                                    : value_of(perspective, third) - value_of(perspective, fourth);
      const float straight = known ? ahead : behind;
      change = abs(straight - next_to) < kStraight * abs(straight) ? straight
               : connected(perspective, pixel, nearest, third)     ? behind
                                                                   : 0.0;
    }
    const float between = here + abs(rest) * change,
                next_value = perspective ? max(between, kLeastNearness * here) : between,
                z = perspective ? 1.0 / next_value : next_value;
    const bool surface = nearest < kSkyDepth && t < end;
    const bool goes_on = open && surface && connected(perspective, pixel, z, last_z);
    const float gap = float(t - anchor), slope = (next_value - anchor_value) / gap;
    const bool fits = goes_on && kEveryPixel == 0u && slope >= low && slope <= high &&
                      ((t - 1 + lines.origin.x) & (kProfileRestart - 1)) != 0;
    const vec2 place = place_at(view, plane, t, z);

    // Loops, not ifs: lavapipe goes through an if in any case.
    for (bool turns = pending && !fits; turns; turns = false) {
      vertex[row + next] = last_z;
      mark[row + next] = uint(t - 1) << 16;
      neighbor[row + t - 1] = columns(next == begin ? -1 : next - 1, next + 1);
      anchor = t - 1;
      anchor_value = value;
      low = -1e30;
      high = 1e30;
      pending = false;
      next++;
    }
    for (bool closes = open && !goes_on; closes; closes = false) {
      const float width =
          length(last - run_start) + pixel * (perspective ? min(last_z, run_start.y / plane.ray_length) : 1.0);
      mark[row + run_begins] = uint(run_step) << 16 | pack_width(width) | kVertexBegins |
                               (run_begins == next - 1 ? kVertexEnds : 0u) | (run_begins == begin ? kVertexFirst : 0u);
      last_mark = uint(t - 1) << 16 | pack_width(width) | kVertexEnds | (run_begins == next - 1 ? kVertexBegins : 0u) |
                  (next - 1 == begin ? kVertexFirst : 0u);
      mark[row + next - 1] = last_mark;
      open = false;
    }
    for (bool begins = surface && !goes_on; begins; begins = false) {
      vertex[row + next] = z;
      neighbor[row + t] = columns(next == begin ? -1 : next - 1, next + 1);
      run_begins = next;
      run_step = t;
      run_start = place;
      open = true;
      anchor = t;
      anchor_value = next_value;
      low = -1e30;
      high = 1e30;
      next++;
    }
    if (goes_on) {
      const float reach = tolerance * (perspective ? next_value : 1.0), run = float(t - anchor);
      neighbor[row + t] = columns(next - 1, next);
      low = max(low, (next_value - reach - anchor_value) / run);
      high = min(high, (next_value + reach - anchor_value) / run);
      pending = true;
    }
    last = place;
    last_z = z;
    value = next_value;
  }
  if (next > begin) {
    mark[row + next - 1] = last_mark | kVertexLast;
    neighbor[row + anchor] = columns(next - 1 == begin ? -1 : next - 2, -1);
  }
}
