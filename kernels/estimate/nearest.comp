// The nearest and the farthest depth in every block of the image, by which `shadow` passes over blocks.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth of what may block.
// Out: two depths per block of kNearestBlock x kNearestBlock pixels, one for each kNearestStep.
// Of sky alone they are kSkyDepth and 0.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { NearestParams params; };
readonly buffer Occluders {
  float occluder_depth[];
};                                             // one float per pixel, depth of the first surfaces that may block
writeonly buffer Nearest { vec2 nearest[]; };  // nearest and farthest per block, rows from the upper left corner

void main() {
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 count = (params.size + kNearestStep - 1) / kNearestStep;
  if (any(greaterThanEqual(block, count))) return;
  const ivec2 first = block * kNearestStep, end = min(first + kNearestBlock, params.size);
  vec2 found = vec2(kSkyDepth, 0);
  for (int y = first.y; y < end.y; y++)
    for (int x = first.x; x < end.x; x++) {
      const float z = occluder_depth[y * params.size.x + x];
      found = vec2(lesser(z, found.x), z < kSkyDepth ? greater(z, found.y) : found.y);
    }
  nearest[block.y * count.x + block.x] = found;
}
