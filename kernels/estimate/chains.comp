// Which pixels of a line show one surface, and where it begins or ends with a rounded outline.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of the first surfaces that may block, view normals.
// Out: three words per 32 pixels of a line, see backs.glsl. A dispatch writes those of all rows or of all columns.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/estimate/solids.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kChainsGroup) in;
layout(constant_id = 0) const uint kSteep = 0;  // 1: along columns
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
writeonly buffer Chains { uint chains[]; };

/// As kRunSlope of slice.glsl.
const float kChainSlope = 8.0;

/// What a pixel of a line shows; beside the line, something of depth 0, which is no surface with anything.
Facet facet_at(View view, int line, int step, int steps) {
  const int at = clamp(step, 0, steps - 1);
  const ivec2 pixel = kSteep != 0u ? ivec2(line, at) : ivec2(at, line);
  const int index = index_of(view, pixel);
  Facet f;
  f.z = at == step ? depth[index] : 0.0;
  f.position = position_of(view, vec2(pixel) + 0.5, f.z);
  f.normal = unpack_normal(normal[index]);
  return f;
}

/// Whether two neighbouring pixels, the second one step on, are one surface. before, after: the pixels beside them.
bool are_one(View view, Facet before, Facet a, Facet b, Facet after) {
  const float pixel = pixels_of(view, min(a.z, b.z)), apart = abs(a.z - b.z);
  const bool recedes = b.z > a.z;
  const vec2 step = kSteep != 0u ? vec2(0, 1) : vec2(1, 0);
  bool one;
  if (apart < kChainSlope * pixel)
    one = !(apart > kParallelSlope * pixel && are_parallel(view, a, b, params.radius));
  else
    one = params.has_normals != 0u &&
          (are_coplanar(view, a, b, kPlaneDot, kPlaneOff) ||
           (recedes ? meet_at_edge(view, b, a, after, -step) : meet_at_edge(view, a, b, before, step)));
  return one && min(a.z, b.z) > 0.0 && max(a.z, b.z) < kSkyDepth;
}

/// Whether a chain of three pixels or more that ends at `end` has a rounded outline there. third: two pixels inward.
bool is_round(View view, Facet beyond, Facet end, Facet third) {
  return beyond.z > end.z && dot(end.normal, toward_eye(view, end.position)) < kRoundFacing &&
         dot(end.normal, third.normal) < kRoundDot;
}

void main() {
  const View view = params.view;
  const int lines = kSteep != 0u ? view.size.x : view.size.y, steps = kSteep != 0u ? view.size.y : view.size.x;
  const int line = int(gl_GlobalInvocationID.x), first = 32 * int(gl_GlobalInvocationID.y);
  if (line >= lines || first >= steps) return;
  // The pixel at a step, two before it, and two after it.
  Facet b2, b1 = facet_at(view, line, first - 2, steps), here = facet_at(view, line, first - 1, steps),
            a1 = facet_at(view, line, first, steps), a2 = facet_at(view, line, first + 1, steps);
  uvec3 word = uvec3(0);
  int i = 0;
  do {
    b2 = b1;
    b1 = here;
    here = a1;
    a1 = a2;
    a2 = facet_at(view, line, first + i + 2, steps);
    const bvec3 bits = bvec3(are_one(view, b2, b1, here, a1), is_round(view, b1, here, a2), is_round(view, a1, here, b2));
    word |= uvec3(bits) << i;
  } while (++i < 32);
  const int at = first_word(view, kSteep != 0u, line) + 3 * (first >> 5);
  chains[at] = word.x;
  chains[at + 1] = word.y;
  chains[at + 2] = word.z;
}
