// How far the chains of pixels that leave a segment of a line go on beyond it.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: chains, see backs.glsl.
// Out: two numbers per segment: the pixels that come before it, of the chain that enters it; and those that come after
// it, of the chain that leaves it.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/estimate/backs.glsl"

layout(local_size_x = kChainsGroup) in;
layout(scalar, push_constant) uniform Push { BacksParams params; };
readonly buffer Chains { uint chains[]; };
writeonly buffer Ends { uint ends[]; };

void main() {
  const View view = params.view;
  const int index = int(gl_GlobalInvocationID.x);
  if (index >= view.size.x + view.size.y) return;
  const Line line = line_at(view, index);
  const int first = line.first, last = first + (line.steps - 1) / kSegment;
  int before = 0, after = 0, at = first;
  do {
    ends[2 * at] = uint(before);
    const uint parted = ~chains[2 * at];
    before = parted == 0u ? before + kSegment : kSegment - findMSB(parted);
  } while (++at <= last);
  at = last;
  do {
    ends[2 * at + 1] = uint(after);
    const uint parted = ~chains[2 * at];
    after = parted == 0u ? after + kSegment : findLSB(parted);
  } while (--at >= first);
}
