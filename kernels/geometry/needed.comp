// Finds the tiles whose estimates anybody needs: those in which the matte takes something, and those about them within
// reach of the filters.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the matte of the frame. Out: 1 for each such tile of the image that is estimated, whose pixels are blocks of the
// frame's, and which may be larger than the frame.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kFactor = 1;  // px of a block in x and in y
layout(scalar, push_constant) uniform Push { NeededParams params; };
readonly buffer Matte { float matte[]; };  // one float per pixel of the frame, from matte
buffer Tiles { uint tiles[]; };            // one uint per tile of the image, zeros before

/// Whether the matte takes something of a block.
bool takes_block(ivec2 block) {
  const ivec2 first = block * kFactor + params.offset;
  bool takes = false;
  for (int i = 0; i < kFactor * kFactor; i++) {
    const ivec2 pixel = first + ivec2(i % kFactor, i / kFactor);
    const bool is_inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, params.frame_size));
    if (is_inside) takes = takes || matte[pixel.y * params.frame_size.x + pixel.x] > 0.0;
  }
  return takes;
}

void main() {
  const ivec2 count = (params.size + kTile - 1) / kTile;
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(tile, count))) return;
  // The blocks of the tile in which the matte takes something.
  ivec2 from = params.size, to = ivec2(-1);
  for (int i = 0; i < kTile * kTile; i++) {
    const ivec2 block = tile * kTile + ivec2(i % kTile, i / kTile);
    if (any(greaterThanEqual(block, params.size)) || !takes_block(block)) continue;
    from = min(from, block);
    to = max(to, block);
  }
  if (to.x < 0) return;
  from = max(from - params.reach, ivec2(0)) / kTile;
  to = min((to + params.reach) / kTile, count - 1);
  // Every invocation that writes a tile writes the same.
  for (int y = from.y; y <= to.y; y++)
    for (int x = from.x; x <= to.x; x++) tiles[y * count.x + x] = 1u;
}
