// How far the chains of pixels that leave a segment of a line go on beyond it.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: chains, see backs.glsl.
// Out: two numbers per segment: the pixels that come before it, of the chain that enters it; and those that come after
// it, of the chain that leaves it. A dispatch writes those of all rows or of all columns.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kChainsGroup) in;
layout(constant_id = 0) const uint kSteep = 0;  // 1: along columns
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Chains { uint chains[]; };
writeonly buffer Ends { uint ends[]; };

void main() {
  const View view = params.view;
  const int lines = kSteep != 0u ? view.size.x : view.size.y, steps = kSteep != 0u ? view.size.y : view.size.x;
  const int line = int(gl_GlobalInvocationID.x);
  if (line >= lines) return;
  const int first = first_segment(view, kSteep != 0u, line), last = first + (steps - 1 >> 5);
  int before = 0, after = 0, at = first;
  do {
    ends[2 * at] = uint(before);
    const uint parted = ~chains[2 * at];
    before = parted == 0u ? before + 32 : 32 - findMSB(parted);
  } while (++at <= last);
  at = last;
  do {
    ends[2 * at + 1] = uint(after);
    const uint parted = ~chains[2 * at];
    after = parted == 0u ? after + 32 : findLSB(parted);
  } while (--at >= first);
}
