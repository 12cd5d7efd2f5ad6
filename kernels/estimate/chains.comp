// Which pixels of a line show one surface, and where it begins or ends with a rounded outline.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth of the first surfaces that may block, view normals.
// Out: two words per 32 pixels of a line, see backs.glsl. A dispatch writes those of all rows or of all columns.
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
  const vec2 step = kSteep != 0u ? vec2(0, 1) : vec2(1, 0);
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
  const bool one = apart < kChainSlope * pixel ? by_depth : params.has_normals != 0u && by_normals;
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
  const int lines = kSteep != 0u ? view.size.x : view.size.y, steps = kSteep != 0u ? view.size.y : view.size.x;
  const int line = int(gl_GlobalInvocationID.x), first = 32 * int(gl_GlobalInvocationID.y);
  if (line >= lines || first >= steps) return;
  // The pixel at a step, two before it, and two after it.
  Facet b2, b1 = facet_at(view, line, first - 2, steps), here = facet_at(view, line, first - 1, steps),
            a1 = facet_at(view, line, first, steps), a2 = facet_at(view, line, first + 1, steps);
  uint links = 0u, rounds = 0u;
  int i = 0;
  do {
    b2 = b1;
    b1 = here;
    here = a1;
    a1 = a2;
    a2 = facet_at(view, line, first + i + 2, steps);
    const bool goes_on = are_one(view, b2, b1, here, a1);
    // Of a chain's two ends the last one goes on from the pixel before it.
    const float beyond = goes_on ? a1.z : b1.z;
    const vec3 third = goes_on ? b2.normal : a2.normal;
    links |= goes_on ? 1u << i : 0u;
    rounds |= is_round(view, beyond, here, third) ? 1u << i : 0u;
  } while (++i < 32);
  const int segment = first_segment(view, kSteep != 0u, line) + (first >> 5);
  chains[2 * segment] = links;
  chains[2 * segment + 1] = rounds;
}
