// Which pixels of a line show one surface, and where it begins or ends with a rounded outline.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of the first surfaces that may block, view normals.
// Out: two words per segment of a row or a column, see backs.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/estimate/solids.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kChainsGroup) in;
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
writeonly buffer Chains { uint chains[]; };

/// What a pixel of a line shows; beside the line, something of depth 0, which is no surface with anything.
Facet facet_at(View view, Line line, int step) {
  const int at = clamp(step, 0, line.steps - 1);
  const ivec2 pixel = line.is_column ? ivec2(line.number, at) : ivec2(at, line.number);
  const int index = index_of(view, pixel);
  const float z = at == step ? depth[index] : 0.0;
  return Facet(position_of(view, vec2(pixel) + 0.5, z), unpack_normal(normal[index]), z);
}

/// Whether two neighbouring pixels, the second one a step on, are one surface. before, after: the pixels beside them.
bool are_one(View view, vec2 step, Facet before, Facet a, Facet b, Facet after) {
  const float pixel = pixel_width(view, min(a.z, b.z)), apart = abs(a.z - b.z);
  const bool recedes = b.z > a.z;
  Facet near = b, far = a, next = before;
  if (recedes) {
    near = a;
    far = b;
    next = after;
  }
  const bool by_depth = !(apart > kParallelSlope * pixel && are_parallel(view, a, b, params.radius));
  const bool by_normals =
      are_coplanar(view, a, b, kPlaneDot, kPlaneOff) || meet_at_edge(view, far, near, next, recedes ? -step : step);
  const bool one = apart < kRunSlope * pixel ? by_depth : params.has_normals != 0u && by_normals;
  return one && min(a.z, b.z) > 0.0 && max(a.z, b.z) < kSkyDepth;
}

/// Whether a chain of three pixels or more that ends at `end` has a rounded outline there. beyond: depth of the pixel
/// beyond it. third: the normal two pixels inward.
bool is_round(View view, float beyond, Facet end, vec3 third) {
  return beyond > end.z && dot(end.normal, toward_eye(view, end.position)) < kRoundFacing &&
         dot(end.normal, third) < kRoundDot;
}

void main() {
  const View view = params.view;
  const ivec2 segments = segments_of(view), all = segments * view.size.yx;  // of rows, and of columns
  const int index = int(gl_GlobalInvocationID.y) * kChainsRow + int(gl_GlobalInvocationID.x);
  if (index >= all.x + all.y) return;
  const bool is_column = index >= all.x;
  const int lines = is_column ? view.size.x : view.size.y, rest = is_column ? index - all.x : index;
  const Line line = line_of(view, is_column, rest % lines);
  const int segment = rest / lines, first = kSegment * segment;
  const vec2 along = line.is_column ? vec2(0, 1) : vec2(1, 0);
  // The pixel at a step, two before it, and two after it.
  Facet b2, b1 = facet_at(view, line, first - 2), here = facet_at(view, line, first - 1),
            a1 = facet_at(view, line, first), a2 = facet_at(view, line, first + 1);
  uint links = 0u, rounds = 0u;
  int i = 0;
  do {
    b2 = b1;
    b1 = here;
    here = a1;
    a1 = a2;
    a2 = facet_at(view, line, first + i + 2);
    const bool goes_on = are_one(view, along, b2, b1, here, a1);
    // Of a chain's two ends the last one goes on from the pixel before it.
    const float beyond = goes_on ? a1.z : b1.z;
    const vec3 third = goes_on ? b2.normal : a2.normal;
    links |= goes_on ? 1u << i : 0u;
    rounds |= is_round(view, beyond, here, third) ? 1u << i : 0u;
  } while (++i < kSegment);
  chains[2 * (line.first + segment)] = links;
  chains[2 * (line.first + segment) + 1] = rounds;
}
