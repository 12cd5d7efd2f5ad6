// Lists the tiles that need more directions: those that err by more than the tolerance, and their neighbours.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: what converge says of every tile.
// Out: the tiles to go on with; of the others the error and, where they are asked for, the moments of what is blocked.
//
// Few directions agree by chance, or all miss the same occluder, and then they do so at all pixels of a tile alike: a
// mean over the tile does not help. Two things are held against it. After 4 directions the difference counts four
// times. And a tile goes on together with any of its 8 neighbours that errs by more than the tolerance: shadows are
// seldom as small as a tile, and where one tile goes on and the next does not, both know what lies at their border.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/exact.h"
#include "kernels/base/view.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/moments.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kOrder = 0;  // of moments, 0 to 2
layout(scalar, push_constant) uniform Push { RefineParams params; };
readonly buffer Depth { float depth[]; };         // one float per pixel, from prepare
readonly buffer Judged { JudgedTile judged[]; };  // one per tile, from converge
readonly buffer List { uint list[]; };            // one uint per tile that had more directions
readonly buffer Counts { TileCounts counts; };
// one float per pixel, the estimated error of its tile; of several radii the mean of theirs
buffer Error { float error[]; };
// one vec2 per tile, sum of the squared errors of its receivers, and their number
writeonly buffer Squares { vec2 squares[]; };
writeonly buffer NextList { uint next[]; };     // one uint per tile that needs more still
buffer NextCounts { TileCounts next_counts; };  // zeros before
// of profile: z is 0, and becomes 1 where any tile needs more
buffer NextLines { GroupCount next_lines; };
// one float per pixel, sum of whole arcs, from exact; only with kOrder
readonly buffer Whole { float whole[]; };
// planes of the sums of moments, from exact; where a tile needs no more directions, the mean ones, as exact has them.
// Only with kOrder.
buffer Moments { float moments[]; };

/// The first directions that decide, and the factor on the error that they say. On six rendered scenes at tolerances of
/// 0.003, 0.01 and 0.03, 354 tiles erred by more than four times the tolerance by their own difference alone, 6 with
/// their neighbours, and none with this factor too.
const uint kFewDirections = 4u;
const float kFewFactor = 4.0;

float error_of(JudgedTile tile) {
  const float rms = sqrt(tile.squares / max(tile.receivers, 1.0));
  return tile.directions == kFewDirections ? kFewFactor * rms : rms;
}

/// Whether a tile, or one beside it that has had as many directions, errs by more than the tolerance.
bool errs_here(ivec2 tile, ivec2 count) {
  bool errs = false;
  for (int y = max(tile.y - 1, 0); y <= min(tile.y + 1, count.y - 1); y++)
    for (int x = max(tile.x - 1, 0); x <= min(tile.x + 1, count.x - 1); x++) {
      const JudgedTile other = judged[y * count.x + x];
      errs = errs || (other.directions == params.directions && error_of(other) > params.tolerance);
    }
  return errs;
}

/// Lists a tile for more directions.
void needs_more(ivec2 tile) {
  const uint at = atomicAdd(next_counts.listed, 1u);
  next[at] = pack_tile(tile);
  const uvec2 groups = dispatch_of_tiles(at + 1u, kTilePixels);
  atomicMax(next_counts.groups.x, groups.x);
  atomicMax(next_counts.groups.y, groups.y);
  atomicMax(next_counts.groups.z, 1u);
  atomicMax(next_lines.z, 1u);
}

/// The mean moments of a pixel, from the sums.
void finish_moments(int index, int plane, bool is_sky) {
  for (int k = 0; k < moments_in(kOrder); k++) {
    const int at = index + k * plane;
    moments[at] = stored_moment(!is_sky && whole[index] > 0.0 ? moments[at] / whole[index] : 0.0);
  }
}

/// Says what is known of a tile that gets no more directions.
void finish(View view, ivec2 tile, int at) {
  const float share = params.share * error_of(judged[at]), receivers = judged[at].receivers;
  float total = 0.0;
  for (uint k = 0u; k < kTilePixels; k++) {
    const ivec2 pixel = pixel_of_anchored_tile(tile, k, params.origin);
    if (!inside(view, pixel)) continue;
    const int index = index_of(view, pixel);
    const bool is_sky = depth[index] >= kSkyDepth;
    const float of_pixel = is_sky ? 0.0 : (params.is_first != 0u ? 0.0 : error[index]) + share;
    error[index] = of_pixel;
    total = max(total, of_pixel);
    finish_moments(index, view.size.x * view.size.y, is_sky);
  }
  squares[at] = vec2(receivers * total * total, receivers);
}

void main() {
  const View view = params.view;
  const ivec2 count = anchored_tiles_of(view.size, params.origin);
  const uint i = invocation_of_tile(count, gl_GlobalInvocationID.xy);
  const bool begins = params.directions == 0u;
  if (i >= (begins ? uint(count.x * count.y) : counts.listed)) return;
  const ivec2 tile = begins ? ivec2(i % uint(count.x), i / uint(count.x)) : unpack_tile(list[i]);
  const int at = tile.y * count.x + tile.x;
  if (begins && judged[at].receivers == 0.0) atomicAdd(next_counts.sky, 1u);
  const bool decides = params.decides != 0u;
  const bool goes_on = judged[at].receivers > 0.0 && params.ends == 0u && (!decides || errs_here(tile, count));
  if (goes_on)
    needs_more(tile);
  else
    finish(view, tile, at);
}
