// Finds the tiles whose estimates anybody needs: those in which the matte takes something, and those within reach of the
// filters about them.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the matte of the frame. Out: 1 for each such tile of the image that is estimated, whose pixels are blocks of the
// frame's, and which may be larger than the frame.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "receivers.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ReceiversParams params; };
layout(scalar, binding = kReceiversMatte) readonly buffer Matte { float matte[]; };
layout(scalar, binding = kReceiversTiles) buffer Tiles { uint tiles[]; };

shared uint takes;

/// Whether the matte takes something of a block.
bool takes_block(ivec2 block) {
  const ivec2 first = block * params.factor + params.offset;
  for (int i = 0; i < params.factor * params.factor; i++) {
    const ivec2 pixel = first + ivec2(i % params.factor, i / params.factor);
    const bool is_inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, params.frame_size));
    if (is_inside && matte[pixel.y * params.frame_size.x + pixel.x] > 0.0) return true;
  }
  return false;
}

void main() {
  // A workgroup is a tile.
  if (gl_LocalInvocationIndex == 0u) takes = 0u;
  barrier();
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(block, params.size)) && takes_block(block)) atomicOr(takes, 1u);
  barrier();
  if (takes == 0u) return;
  const ivec2 count = (params.size + kTile - 1) / kTile;
  const int side = 2 * params.reach + 1;
  for (int i = int(gl_LocalInvocationIndex); i < side * side; i += int(kGroupX * kGroupY)) {
    const ivec2 tile = ivec2(gl_WorkGroupID.xy) + ivec2(i % side, i / side) - params.reach;
    // Every invocation that writes it writes the same.
    if (all(greaterThanEqual(tile, ivec2(0))) && all(lessThan(tile, count))) tiles[tile.y * count.x + tile.x] = 1u;
  }
}
