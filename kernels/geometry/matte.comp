// Makes one plane of coverage of what a matte's file holds.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: a plane of coverage or of objects, or ranks of objects with their coverage.
// Out: how much of each pixel the matte takes, 0 to 1. What is no number takes nothing.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kForm = kMatteCoverage;  // one of kMatte*
layout(constant_id = 1) const uint kRanks = 1;              // pairs of planes; of other forms 1
layout(scalar, push_constant) uniform Push { MatteParams params; };
readonly buffer Raw { float raw[]; };         // planes of floats, as in the file
readonly buffer Objects { uint objects[]; };  // one uint per object that is meant, the bits of its float; rising
writeonly buffer Result { float result[]; };  // one float per pixel, 0 to 1

/// Whether an object is among those that are meant.
bool is_meant(uint object) {
  uint from = 0u, to = params.objects;  // it is not before the one, and before the other
  while (to - from > 1u) {
    const uint middle = (from + to) / 2u;
    if (objects[middle] <= object)
      from = middle;
    else
      to = middle;
  }
  return params.objects > 0u && objects[from] == object;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const uint index = uint(pixel.y * params.size.x + pixel.x), plane = uint(params.size.x * params.size.y);
  float taken = kForm == kMatteCoverage ? raw[index] : 0.0;
  for (uint rank = 0u; rank < kRanks && kForm != kMatteCoverage; rank++) {
    const float coverage = kForm == kMatteRanked ? raw[index + (2u * rank + 1u) * plane] : 1.0;
    if (coverage == 0.0) continue;  // as are most beyond the first rank
    if (is_meant(floatBitsToUint(raw[index + 2u * rank * plane]))) taken += coverage;
  }
  result[index] = is_finite(taken) ? clamp(taken, 0.0, 1.0) : 0.0;
}
