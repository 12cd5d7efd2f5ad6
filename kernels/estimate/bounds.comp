// Bounds the depth of what is hidden in every block of 2 x 2 tiles.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, planes of hidden surfaces.
// Out: the nearest and the farthest depth for each block, by which `classify` tells where hidden surfaces may count.
//
// A surface that closes a solid says something from the front of that on.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { BoundsParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel, from prepare
readonly buffer Hidden { float hidden[]; };  // planes of hidden surfaces, see GBuffer
// nearest and farthest depth per block of tiles, rows of blocks from the upper left corner; nothing hidden:
// kSkyDepth, 0
writeonly buffer Blocks { vec2 blocks[]; };

void main() {
  const ivec2 size = params.size, block = ivec2(gl_GlobalInvocationID.xy), count = blocks_of(size);
  if (any(greaterThanEqual(block, count))) return;
  const ivec2 first = block * kTile * kTileBlock, end = min(first + kTile * kTileBlock, size);
  float nearest = kSkyDepth, farthest = 0.0;
  for (int y = first.y; y < end.y; y++)
    for (int x = first.x; x < end.x; x++) {
      float before = depth[y * size.x + x];
      const uint surfaces = before < kSkyDepth ? params.hidden : 0u;
      for (uint k = 0u; k < surfaces; k++) {
        const float z = hidden[(int(k) * size.y + y) * size.x + x];
        if (abs(z) < kSkyDepth) {
          nearest = min(nearest, z < 0.0 ? before : z);
          farthest = max(farthest, abs(z));
        }
        before = abs(z);
      }
    }
  blocks[block.y * count.x + block.x] = vec2(nearest, farthest);
}
