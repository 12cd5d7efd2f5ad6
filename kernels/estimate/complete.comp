// Completes the profiles of the lines of one direction: how far surfaces go on behind what is nearer.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the vertices of profile.comp.
// Out: for each run's first and last vertex where the surface goes on unseen the end of the straight stroke by which it
// does.
//
// - A plane is straight in 1/z along a line (orthographic: in z), so a surface goes on as a straight stroke. Its slope
//   is the mean of two: of the line through the last vertices of the run, which follows what curves, and of the plane
//   across the normal at its end, which holds where a run is only a few pixels wide.
// - It goes on where the next step shows a nearer surface, as far as it stays behind what is seen. Where the next step
//   shows sky, or something farther, the surface ends.
// - No stroke is longer than so many radii that a part of the frame need be read around no farther than what its
//   receivers see; nearly all that matters is shorter.
// - What goes on behind the last surface before the image's border ends there.
// - Where hidden surfaces are known, the first surface of a pixel goes on if it is not known to go on there: where the
//   frame tells all surfaces of a pixel up to so many, behind the last of others that have as many; else behind the
//   first of others.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/exact.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/estimate/lines.glsl"

layout(local_size_x = kCompleteGroup) in;
// of a pixel. Of several, the profile is a plane among others, and `behind` is of that one alone of which surfaces
// go on behind what is nearer.
layout(constant_id = 0) const uint kSurfaces = 1;
// 1: the frame tells all surfaces of a pixel, but for those behind as many as it may have
layout(constant_id = 1) const uint kWhole = 0;
layout(scalar, push_constant) uniform Push { CompleteParams params; };
buffer Vertex { float vertex[]; };  // from profile; a vertex from which its surface goes on has its depth negated
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer Mark { uint mark[]; };      // from profile
// one uint for each vertex with a negative depth: up to where its surface goes on (pack_goes_on())
writeonly buffer GoesOn { uint goes_on[]; };
// one uint per vertex: the columns of the nearest vertices before (low half) and after it (high half) whose surface
// goes on behind it; kNoVertex: none
buffer Behind { uint behind[]; };
readonly buffer Depth { float depth[]; };    // as profile's; only with several surfaces
readonly buffer Hidden { float hidden[]; };  // planes of floats, see GBuffer::hidden; only with several surfaces

/// A surface goes on until it is so many times as deep as at its last vertex.
const float kLeastDepths = 1.0 / 64.0;
const float kMostDepths = 15.9;

/// Of a stroke, in radii: as core/run/tiles.cpp reads around a part. With 2 colonnade, whose walls go on far behind
/// its columns, has an RMSE of .0639 instead of .0627, with 4 .0617.
const float kLongest = 3.0;

/// Longer strokes than this, in steps, are not needed for any image.
const float kLongestStroke = 8191.0;

struct Corner {
  uint marked;
  int at;          // the step
  float nearness;  // what is straight along a line, larger where the surface is nearer: 1/z, orthographic -z
  float hides;     // what goes on nearer than this is seen there, or known; kNothing: all is
};

const float kNothing = -1e30;

/// A surface is seen where it lies less than so many pixels' widths behind what is seen, as where it comes to light
/// again: rounding decides nothing there. Profiles are within 0.2 of their pixels.
const float kSeenWithin = 0.25;

float nearness_of(bool perspective, float z) { return perspective ? value_of(true, z) : -value_of(false, z); }

/// The nearness of the last surface of a pixel where the frame tells all up to so many: behind fewer there are no more.
float last_of_full(View view, Lines lines, int line, int step) {
  const int pixel = index_at(view, lines, step, line + shift_at(lines, step));
  const float z = abs(hidden[int(kSurfaces - 2u) * view.size.x * view.size.y + pixel]);
  return z < kSkyDepth ? nearness_of(view.orthographic == 0, z) : kNothing;
}

Corner corner_at(View view, Lines lines, int line, int index) {
  const bool perspective = view.orthographic == 0;
  Corner c;
  c.marked = mark[index];
  c.at = int(c.marked >> 16);
  c.nearness = nearness_of(perspective, abs(vertex[index]));
  const float last = kWhole != 0u ? last_of_full(view, lines, line, c.at) : c.nearness;
  c.hides = last - kSeenWithin * view.tangent_per_pixel.x * (perspective ? last : 1.0);
  return c;
}

/// A surface that goes on behind what is seen so far.
struct Open {
  bool is_open;
  int index;       // of the vertex from which it goes on
  float from;      // the step of that
  float nearness;  // there
  float slope;     // of the nearness, per step of the walk
  float farthest;  // steps that it goes on at most
};

/// The surfaces that go on at one place of a line, the latest first. Of more, the first to have gone behind what is
/// seen ends.
struct Opens {
  Open a, b, c;
};

/// The vertices that a walk along the line has passed.
struct Walk {
  int way;               // 1 or -1
  uint begins, is_last;  // the flags of vertices, as the walk meets them
  Corner before, prior;  // the last vertex, and the one before it
  // the vertex of the last one's run that says with it how the surface goes on: two steps away at least, where the run
  // is so long
  Corner inner;
};

/// The steps after which a value that changes so much per step leaves the range of depths in which surfaces go on.
float steps_in_range(bool perspective, float value, float change) {
  const float least = perspective ? 1.0 / kMostDepths : kLeastDepths;
  const float most = perspective ? 1.0 / kLeastDepths : kMostDepths;
  const float room = value * (change < 0.0 ? 1.0 - least : most - 1.0);
  return room / max(abs(change), room / kLongestStroke);
}

/// A vertex that is farther from its pixel's first surface than so many pixels' worth of slope is of another one.
const float kOfFirstSurface = 8.0;

/// Whether a vertex is of the first surface of its pixel, which alone has a normal.
bool is_first_surface(View view, int pixel, float nearness) {
  if (kSurfaces == 1u) return true;
  const bool perspective = view.orthographic == 0;
  const float z = perspective ? 1.0 / nearness : -nearness;
  return abs(z - depth[pixel]) < kOfFirstSurface * view.tangent_per_pixel.x * (perspective ? z : 1.0);
}

/// The change of nearness per step `way` on the plane through a vertex across the normal there; `otherwise` where that
/// is seen edge on, or not known.
float change_on_plane(View view, Lines lines, LinePlane plane, int line, Corner end, float way, float otherwise) {
  const bool perspective = view.orthographic == 0;
  const ivec2 along_and_across = ivec2(end.at, line + shift_at(lines, end.at));
  const int pixel = index_at(view, lines, along_and_across.x, along_and_across.y);
  const vec3 n = unpack_normal(normal[pixel]);
  const vec2 tangent = tangent_at(view, lines, along_and_across + lines.origin);
  const float facing = (perspective ? dot(n.xy, tangent) : 0.0) - n.z;
  const float change = way * plane.step * dot(n.xy, plane.along) * (perspective ? end.nearness : 1.0) / facing;
  const bool is_known = facing < -kLeastFacingToGoOn && is_first_surface(view, pixel, end.nearness);
  return is_known ? change : otherwise;
}

/// The surface that goes on from the walk's last vertex, along the line through `inner` and that vertex.
Open from_end(View view, Lines lines, LinePlane plane, int line, Walk walk, Corner inner, int index) {
  const bool perspective = view.orthographic == 0;
  const Corner end = walk.before;
  const float scale = perspective ? 1.0 / end.nearness : 1.0;
  Open open;
  open.is_open = true;
  open.index = index;
  open.from = float(end.at);
  open.nearness = end.nearness;
  const float by_line = (end.nearness - inner.nearness) / float(abs(end.at - inner.at));
  const float by_plane = change_on_plane(view, lines, plane, line, end, float(walk.way), by_line);
  open.slope = 0.5 * (by_line + by_plane);
  const float in_range = steps_in_range(perspective, abs(end.nearness), perspective ? open.slope : -open.slope);
  open.farthest = min(ceil(kLongest * params.radius / (scale * plane.step)), in_range);
  return open;
}

/// Ends what goes on from a vertex so many steps from there, or where it is kLongest radii long. Pixels grow with the
/// depth, so steps do not tell its length.
void close(inout Open open, View view, LinePlane plane, int way, float steps) {
  const bool perspective = view.orthographic == 0;
  const float nearness = open.nearness + open.slope * steps;
  const float z = perspective ? 1.0 / open.nearness : -open.nearness;
  const float end_z = z * (perspective ? open.nearness / nearness : max(nearness / open.nearness, 0.0));
  // Steps are counted from the display window's corner, so that a part of the frame rounds as the whole does.
  const float first = float(plane.origin + int(open.from)), last = first + float(way) * steps;
  const vec2 from = vec2((perspective ? z : 1.0) * (plane.start + first * plane.step), z * plane.ray_length);
  const vec2 to = vec2((perspective ? end_z : 1.0) * (plane.start + last * plane.step), end_z * plane.ray_length);
  const vec2 end = from + min(kLongest * params.radius / max(length(to - from), 1e-30), 1.0) * (to - from);
  const float kept_z = end.y / plane.ray_length;
  const float kept_step = (end.x / (perspective ? kept_z : 1.0) - plane.start) / plane.step;
  const float kept = min(steps, abs(kept_step - first));
  if (kept > 0.0) {
    goes_on[open.index] = pack_goes_on(kept, kept_z / z);
    vertex[open.index] = -abs(vertex[open.index]);
  }
  open.is_open = false;
}

/// Goes on from the walk's last vertex to the next one, and ends what would be seen until there.
void extend(inout Open open, View view, LinePlane plane, Walk walk, Corner next, bool begins_run) {
  const float to_before = abs(float(walk.before.at) - open.from), to_next = abs(float(next.at) - open.from);
  const float behind_before = walk.before.hides - open.nearness - open.slope * to_before;
  const float behind_next = next.hides - open.nearness - open.slope * to_next;
  const bool after_sky = begins_run && abs(next.at - walk.before.at) > 1;
  const bool is_hidden = !after_sky && behind_next > 0.0;
  const bool ends = !is_hidden || to_next >= open.farthest;
  if (open.is_open && ends) {
    float steps = begins_run ? to_before : mix(to_before, to_next, behind_before / (behind_before - behind_next));
    if (is_hidden) steps = to_next;
    close(open, view, plane, walk.way, min(steps, open.farthest));
  }
}

/// The index at which the plane of the profile begins.
int first_of_plane(View view) { return kSurfaces == 1u ? 0 : int(params.slot) * view.size.x * view.size.y; }

/// Walks along the vertices of a line from `first` on; it has one at least.
void complete(View view, Lines lines, LinePlane plane, int line, int row, int first, int way) {
  Walk walk;
  walk.way = way;
  walk.begins = way > 0 ? kVertexBegins : kVertexEnds;
  walk.is_last = way > 0 ? kVertexLast : kVertexFirst;
  const uint both_ends = kVertexBegins | kVertexEnds;
  walk.before = corner_at(view, lines, line, first);
  walk.prior = walk.before;
  walk.inner = walk.before;
  Open none;
  none.is_open = false;
  none.index = 0;
  none.from = none.nearness = none.slope = none.farthest = 0.0;
  Opens opens = Opens(none, none, none);
  int index = first;
  bool goes = (walk.before.marked & walk.is_last) == 0u;
  if (goes) {
    do {
      index += way;
      const Corner next = corner_at(view, lines, line, index);
      const bool begins_run = (next.marked & walk.begins) != 0u;
      const bool is_interrupted = begins_run && (walk.before.marked & both_ends) != both_ends &&
                                  next.at == walk.before.at + way && next.hides > walk.before.nearness;
      goes = (next.marked & walk.is_last) == 0u;
      if (is_interrupted) {
        if (opens.a.is_open && opens.b.is_open) {
          if (opens.c.is_open) close(opens.c, view, plane, way, abs(float(walk.before.at) - opens.c.from));
          opens.c = opens.b;
        }
        if (opens.a.is_open) opens.b = opens.a;
        opens.a = from_end(view, lines, plane, line, walk, walk.inner, index - way);
      }
      extend(opens.a, view, plane, walk, next, begins_run);
      extend(opens.b, view, plane, walk, next, begins_run);
      extend(opens.c, view, plane, walk, next, begins_run);
      uint column = kNoVertex;
      if (opens.c.is_open) column = uint(opens.c.index - row);
      if (opens.b.is_open) column = uint(opens.b.index - row);
      if (opens.a.is_open) column = uint(opens.a.index - row);
      const int at = index - first_of_plane(view);
      behind[at] = way > 0 ? column | kNoVertex << 16 : behind[at] & kNoVertex | column << 16;
      const bool is_long = abs(next.at - walk.before.at) > 1;
      const bool before_begins = (walk.before.marked & walk.begins) != 0u;
      walk.inner = is_long || before_begins ? walk.before : walk.prior;
      if (begins_run) walk.inner = next;
      walk.prior = walk.before;
      walk.before = next;
    } while (goes);
  }
  // What still goes on at the walk's end ends there.
  const float end = float(walk.before.at);
  if (opens.a.is_open) close(opens.a, view, plane, way, min(abs(end - opens.a.from), opens.a.farthest));
  if (opens.b.is_open) close(opens.b, view, plane, way, min(abs(end - opens.b.from), opens.b.farthest));
  if (opens.c.is_open) close(opens.c, view, plane, way, min(abs(end - opens.c.from), opens.c.farthest));
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
  const int row = first_of_plane(view) + row_of(lines, line, extent.y) * extent.x;
  if (mark[row + steps.x] == 0u) return;
  behind[row + steps.x - first_of_plane(view)] = kNoVertex | kNoVertex << 16;
  complete(view, lines, plane, line, row, row + steps.x, 1);
  int last = row + steps.x;
  while ((mark[last] & kVertexLast) == 0u) last++;
  complete(view, lines, plane, line, row, last, -1);
}
