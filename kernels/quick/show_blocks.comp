// Writes the sites of blocks as rows of tiles, and their visibility as pixels, for debug views.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the words of blocks, the visibility of their sites. Out: words of tiles, see tiles.glsl, of which only the sites
// are told; visibility at sites. An invocation makes a row of a tile.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/quick/quick.h"
#include "kernels/base/view.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/quick/blocks.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { BlocksParams params; };
readonly buffer Blocks { uint words[]; };  // from block_sites
readonly buffer Seen { float seen[]; };    // from quick_horizon
writeonly buffer Rows { uint rows[]; };    // 8 words per tile
writeonly buffer Ao { float ao[]; };       // one float per pixel

void main() {
  const View view = params.view;
  const ivec2 row = ivec2(gl_GlobalInvocationID.xy), first = ivec2(row.x * kTile, row.y), tiles = tiles_of(view.size);
  if (!inside(view, first)) return;
  uint sites = 0u;
  for (int i = 0; i < kTile && first.x + i < view.size.x; i++) {
    const ivec2 pixel = first + ivec2(i, 0), at = pixel + params.overhang, block = at / kBlock;
    const int number = block.y * params.blocks.x + block.x;
    for (uint s = 0u; s < sites_in(words[number]); s++) {
      if (any(notEqual(place_of_site(words[number], s), at - block * kBlock))) continue;
      sites |= 1u << uint(i);
      ao[index_of(view, pixel)] = seen[number * kBlockSites + int(s)];
    }
  }
  rows[word_of_pixel(first, tiles)] = sites << kSiteByte;
}
