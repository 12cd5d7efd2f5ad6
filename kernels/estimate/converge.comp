// Judges tiles of an exact search: the estimate of all directions so far is compared with that of every other one.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the sums of an exact search over directions in bit-reversed order, so that 2, 4, 8 ... of them are even over the
// half turn.
// Out: visibility, and its estimated error over every tile; refine decides by it.
//
// What is integrated over directions is smooth but for the edges of occluders, so the error of n even directions falls
// about as 1 / n where there is a jump, and faster without. The estimate of n / 2 directions then errs by twice as
// much, and their difference by about as much as the estimate of n. The difference is a random number at each pixel, so
// the root of its mean square over a tile of 8 x 8 pixels is taken.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/exact.h"
#include "kernels/base/view.glsl"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ConvergeParams params; };
readonly buffer Depth { float depth[]; };      // one float per pixel, from prepare
readonly buffer Blocked { float blocked[]; };  // one float per pixel, sum of blocked arcs, from exact
readonly buffer Whole { float whole[]; };      // one float per pixel, sum of whole arcs, from exact
// one float per pixel, visibility by half of the directions, then by all; the plane of the parameters
buffer Ao { float ao[]; };
writeonly buffer Judged { JudgedTile judged[]; };  // one per tile
readonly buffer List { uint list[]; };             // one uint per tile that had more directions, from refine
readonly buffer Counts { TileCounts counts; };     // from refine

/// The error of the better estimate, as a part of the difference between both: measured on rendered frames, 0.60 to
/// 0.75.
const float kErrorShare = 0.75;

void main() {
  const View view = params.view;
  const ivec2 count = anchored_tiles_of(view.size, params.origin);
  const uint i = invocation_of_tile(count, gl_GlobalInvocationID.xy);
  const bool begins = params.directions == 0u;
  if (i >= (begins ? uint(count.x * count.y) : counts.listed)) return;
  const ivec2 tile = begins ? ivec2(i % uint(count.x), i / uint(count.x)) : unpack_tile(list[i]);
  const int plane = int(params.plane) * view.size.x * view.size.y;
  float sum = 0.0, receivers = 0.0;
  for (uint k = 0u; k < kTilePixels; k++) {
    const ivec2 pixel = pixel_of_anchored_tile(tile, k, params.origin);
    if (!inside(view, pixel)) continue;
    const int index = index_of(view, pixel);
    const bool is_sky = depth[index] >= kSkyDepth;
    float visibility = 1.0;
    if (!begins && !is_sky) {
      visibility = whole[index] > 0.0 ? clamp(1.0 - blocked[index] / whole[index], 0.0, 1.0) : 1.0;
      const float difference = visibility - ao[index + plane];
      sum += kErrorShare * kErrorShare * difference * difference;
    }
    ao[index + plane] = visibility;
    receivers += is_sky ? 0.0 : 1.0;
  }
  judged[tile.y * count.x + tile.x] = JudgedTile(sum, receivers, params.directions);
}
