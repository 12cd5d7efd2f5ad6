// Completes the profiles of the lines of one direction: how far surfaces go on behind what is nearer, and beyond the
// image's border.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the vertices of profile.comp.
// Out: for each run's first and last vertex where the surface goes on unseen the end of the straight stroke by which it
// does.
//
// - A plane is straight in 1/z along a line (orthographic: in z), so a surface goes on along the line through the last
//   two vertices of its run.
// - It goes on where the next step shows a nearer surface, as far as it stays behind what is seen. Where the next step
//   shows sky, or something farther, the surface ends.
// - A stroke that is as long as the sphere of the radius is wide is long enough for every receiver.
// - The image's border hides all that is beyond it, so there a surface goes on as far as that. Where the image is a part
//   of the frame, no result lies within the radius of a border that is not the frame's: see core/run/region.h.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "complete.h"
#include "view.glsl"
#include "lines.glsl"

layout(local_size_x = kCompleteGroup) in;
layout(scalar, push_constant) uniform Push { CompleteParams params; };
layout(scalar, binding = kCompleteVertex) buffer Vertex { float vertex[]; };
layout(scalar, binding = kCompleteMark) readonly buffer Mark { uint mark[]; };
layout(scalar, binding = kCompleteGoesOn) writeonly buffer GoesOn { vec2 goes_on[]; };
layout(scalar, binding = kCompleteBehind) buffer Behind { uint behind[]; };

/// A surface goes on until its disparity has fallen to this part of what it is at its last vertex.
const float kLeastDisparity = 0.02;

/// A run of fewer pixels than this does not tell how its surface goes on beyond the border.
const int kLeastAtBorder = 3;

/// Longer strokes than this, in steps, are not needed for any image.
const float kLongestStroke = 65536.0;

struct Corner {
  uint marked;
  int at;         // the step
  float nearness;  // what is straight along a line, larger where the surface is nearer: 1/z, orthographic -z
};

Corner corner_at(bool perspective, int index) {
  Corner c;
  c.marked = mark[index];
  c.at = int(c.marked >> 16);
  const float value = value_of(perspective, abs(vertex[index]));
  c.nearness = perspective ? value : -value;
  return c;
}

/// The step up to which a surface goes on behind what is seen, from a run's end at `index`; its own where it does not.
float hidden_until(bool perspective, int row, int index, int way, Corner end, float slope, float farthest) {
  const uint column = uint(index - row);
  const uint begins = way > 0 ? kVertexBegins : kVertexEnds;
  const uint is_last = way > 0 ? kVertexLast : kVertexFirst;
  Corner before = end;
  float until = float(end.at);
  for (bool goes = true; goes;) {
    index += way;
    const Corner next = corner_at(perspective, index);
    const float depth_behind = next.nearness - end.nearness - slope * float(next.at - end.at);
    const bool begins_run = (next.marked & begins) != 0u;
    const bool after_sky = begins_run && abs(next.at - before.at) > 1;
    const float before_behind = before.nearness - end.nearness - slope * float(before.at - end.at);
    goes = !after_sky && depth_behind > 0.0;
    for (bool once = goes; once; once = false) {
      until = float(next.at);
      const uint others = behind[index];
      if (way > 0) behind[index] = others & 0xffff0000u | column;
      if (way < 0 && others >> 16 == kNoVertex) behind[index] = others & kNoVertex | column << 16;
    }
    if (!goes && !begins_run)
      until = float(before.at) + float(next.at - before.at) * before_behind / (before_behind - depth_behind);
    if (abs(until - float(end.at)) >= farthest || (next.marked & is_last) != 0u) goes = false;
    before = next;
  }
  return until;
}

/// Writes where the surface of the run's end at `index` goes on to; `way` leads out of the run.
void complete(View view, LinePlane plane, ivec2 steps, int row, int index, int way) {
  const bool perspective = view.orthographic == 0;
  const Corner end = corner_at(perspective, index);
  Corner inner = corner_at(perspective, index - way);
  const uint other_end = way > 0 ? kVertexBegins : kVertexEnds;
  if (abs(end.at - inner.at) < 2 && (inner.marked & other_end) == 0u) inner = corner_at(perspective, index - 2 * way);
  const float slope = (end.nearness - inner.nearness) / float(end.at - inner.at);
  const float z = perspective ? 1.0 / end.nearness : -end.nearness;
  float farthest = min(ceil(2.0 * params.radius / ((perspective ? z : 1.0) * plane.step)), kLongestStroke);
  const float falling = -slope * float(way);
  if (perspective && falling > 0.0) farthest = min(farthest, (1.0 - kLeastDisparity) * end.nearness / falling);
  const bool at_border = end.at + way < steps.x || end.at + way >= steps.y;
  const bool is_last = (end.marked & (way > 0 ? kVertexLast : kVertexFirst)) != 0u;
  float until = float(end.at);
  if (at_border) {
    if (abs(end.at - inner.at) >= kLeastAtBorder - 1) until += float(way) * farthest;
  } else if (params.behind != 0 && !is_last) {
    const Corner next = corner_at(perspective, index + way);
    if (next.at == end.at + way && next.nearness > end.nearness)
      until = hidden_until(perspective, row, index, way, end, slope, farthest);
  }
  until = clamp(until, float(end.at) - farthest, float(end.at) + farthest);
  if (until == float(end.at)) return;
  const float nearness = end.nearness + slope * (until - float(end.at));
  goes_on[index] = vec2(until, perspective ? 1.0 / nearness : -nearness);
  vertex[index] = -z;
}

void main() {
  if (gl_GlobalInvocationID.x >= params.count) return;
  const View view = params.view;
  const Lines lines = params.lines;
  const ivec2 extent = extent_of(view, lines);
  const int line = params.first + int(gl_GlobalInvocationID.x);
  const ivec2 steps = steps_of(lines, extent, line);
  if (steps.x >= steps.y) return;
  const LinePlane plane = plane_of(view, lines, line);
  const int row = row_of(lines, line, extent.y) * extent.x;
  int index = row + steps.x;
  for (bool goes = mark[index] != 0u; goes; index++) {
    behind[index] = kNoVertex | kNoVertex << 16;
    goes = (mark[index] & kVertexLast) == 0u;
  }
  index = row + steps.x;
  for (bool goes = mark[index] != 0u; goes; index++) {
    const uint marked = mark[index];
    const uint ends = marked & (kVertexBegins | kVertexEnds);
    for (bool once = ends == kVertexBegins || ends == kVertexEnds; once; once = false)
      complete(view, plane, steps, row, index, ends == kVertexEnds ? 1 : -1);
    goes = (marked & kVertexLast) == 0u;
  }
}
