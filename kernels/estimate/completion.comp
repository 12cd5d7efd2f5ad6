// Adds up, tile by tile, the visibility that completed surfaces took, and all that was taken.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: depth, the visibility of an estimate, and what of it completed surfaces took, at sites. Those of the widest
// lattice alone count, which stand for equal shares of the image.
// Out: both sums for each tile of 8 x 8 pixels. Each is made by one invocation, in the order of the pixels, so that its
// bits do not depend on the order of invocations; the host adds up the tiles.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CompletionParams params; };
readonly buffer Depth { float depth[]; };          // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Ao { float ao[]; };                // one float per pixel, visibility; the plane of the parameters
readonly buffer Completed { float completed[]; };  // one float per pixel, visibility that completed surfaces took
// one vec2 per tile, sums over its receivers of the visibility that is taken by completed surfaces, and by all
writeonly buffer Sums { vec2 sums[]; };

void main() {
  const View view = params.view;
  const ivec2 origin = params.origin;
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 count = tiles_of(view.size);
  if (any(greaterThanEqual(tile, count))) return;
  const int plane = int(params.plane) * view.size.x * view.size.y;
  vec2 sum = vec2(0);
  for (uint k = 0u; k < kTilePixels; k++) {
    const ivec2 pixel = pixel_of_tile(tile, k);
    const uint lattice = lattice_row(ivec2(tile.x * kTile, pixel.y) + origin, params.spacing);
    if (!inside(view, pixel) || (lattice >> k % uint(kTile) & 1u) == 0u) continue;
    const int index = index_of(view, pixel);
    if (depth[index] >= kSkyDepth) continue;
    sum += vec2(completed[index], 1.0 - ao[index + plane]);
  }
  sums[tile.y * count.x + tile.x] = sum;
}
