// Finds the tiles that need more directions: the estimate of all directions so far is compared with that of every other
// one.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the sums of an exact search over directions in bit-reversed order, so that 2, 4, 8 ... of them are even over the
// half turn.
// Out: visibility, its estimated error, and the tiles where that is larger than the tolerance. Where it is asked for,
// the mean open direction of the others.
//
// What is integrated over directions is smooth but for the edges of occluders, so the error of n even directions falls
// about as 1 / n where there is a jump, and faster without. The estimate of n / 2 directions then errs by twice as
// much, and their difference by about as much as the estimate of n. The difference is a random number at each pixel, so
// the root of its mean square over a tile of 8 x 8 pixels is taken.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "converge.h"
#include "view.glsl"
#include "tiles.glsl"
#include "normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kConvergeBentId) const uint kBent = 0;
layout(scalar, push_constant) uniform Push { ConvergeParams params; };
layout(scalar, binding = kConvergeDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kConvergeBlocked) readonly buffer Blocked { float blocked[]; };
layout(scalar, binding = kConvergeWhole) readonly buffer Whole { float whole[]; };
layout(scalar, binding = kConvergeAo) buffer Ao { float ao[]; };
layout(scalar, binding = kConvergeError) writeonly buffer Error { float error[]; };
layout(scalar, binding = kConvergeSquares) writeonly buffer Squares { vec2 squares[]; };
layout(scalar, binding = kConvergeList) readonly buffer List { ListedTile list[]; };
layout(scalar, binding = kConvergeCounts) readonly buffer Counts { TileCounts counts; };
layout(scalar, binding = kConvergeNextList) writeonly buffer NextList { ListedTile next[]; };
layout(scalar, binding = kConvergeNextCounts) buffer NextCounts { TileCounts next_counts; };
layout(scalar, binding = kConvergeNextLines) buffer NextLines { GroupCount next_lines; };
layout(scalar, binding = kConvergeNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kConvergeBent) buffer Bent { float bent[]; };

/// Of the difference between both estimates, the error of the better one: measured on rendered frames, 0.60 to 0.75.
const float kErrorShare = 0.75;

/// Lists a tile for more directions.
void needs_more(uint place) {
  const uint at = atomicAdd(next_counts.listed, 1u);
  next[at].place = place;
  const uvec2 groups = dispatch_of_tiles(at + 1u, kTilePixels);
  atomicMax(next_counts.groups.x, groups.x);
  atomicMax(next_counts.groups.y, groups.y);
  atomicMax(next_counts.groups.z, 1u);
  atomicMax(next_lines.z, 1u);
}

/// Makes the mean open directions of a tile from the sums of what is blocked.
void finish_bent(View view, ivec2 tile) {
  const int plane = view.size.x * view.size.y;
  for (uint k = 0u; k < uint(kTile * kTile); k++) {
    const ivec2 pixel = pixel_of_anchored_tile(tile, k, params.origin);
    if (!inside(view, pixel)) continue;
    const int index = index_of(view, pixel);
    const bool is_sky = depth[index] >= kSkyDepth;
    const vec3 open = is_sky ? vec3(0) : open_bent(unpack_normal(normal[index]));
    for (int c = 0; c < 3; c++) {
      const int at = index + c * plane;
      const float blocks = !is_sky && whole[index] > 0.0 ? bent[at] / whole[index] : 0.0;
      bent[at] = stored_bent(vec3(open[c] - blocks)).x;
    }
  }
}

void main() {
  const View view = params.view;
  const ivec2 count = anchored_tiles_of(view.size, params.origin);
  // The invocations of a row of workgroups, from the grid of tiles: gl_NumWorkGroups counts those of one slice only.
  const uint row = (uint(count.x) + kGroupX - 1u) / kGroupX * kGroupX;
  const uint i = gl_GlobalInvocationID.y * row + gl_GlobalInvocationID.x;
  const bool begins = params.directions == 0u;
  if (i >= (begins ? uint(count.x * count.y) : counts.listed)) return;
  const uint place = begins ? pack_tile(ivec2(i % uint(count.x), i / uint(count.x))) : list[i].place;
  const ivec2 tile = unpack_tile(place);
  const int plane = int(params.plane) * view.size.x * view.size.y;
  float sum = 0.0, receivers = 0.0;
  for (uint k = 0u; k < uint(kTile * kTile); k++) {
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
  const float rms = sqrt(sum / max(receivers, 1.0));
  const bool known = params.decides != 0u;
  if (known || begins) {
    for (uint k = 0u; k < uint(kTile * kTile); k++) {
      const ivec2 pixel = pixel_of_anchored_tile(tile, k, params.origin);
      if (inside(view, pixel)) error[index_of(view, pixel)] = depth[index_of(view, pixel)] >= kSkyDepth ? 0.0 : rms;
    }
    squares[tile.y * count.x + tile.x] = vec2(sum, receivers);
  }
  if (begins && receivers == 0.0) atomicAdd(next_counts.sky, 1u);
  const bool goes_on = receivers > 0.0 && (!known || rms > params.tolerance);
  if (goes_on) needs_more(place);
  if (kBent != 0u && (!goes_on || params.ends != 0u)) finish_bent(view, tile);
}
