// Chooses the sites of each block of 4 x 4 pixels, one on each surface that it shows, and lists them.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, needed tiles.
// Out: the words of blocks and the planes of sites, see blocks.glsl; the list of sites; depth with a margin.
//
// The first site is a pixel beside the block's middle. It stands for the pixels that lie in its plane, and it in
// theirs. The next site is one of the others. An invocation computes a block.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/quick/quick.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/quick/blocks.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSelects = 0;  // 1: only blocks of needed tiles have sites
layout(scalar, push_constant) uniform Push { BlocksParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };   // one uint per pixel, from prepare
readonly buffer Needed { uint needed[]; };   // one uint per tile; only if it selects
writeonly buffer Wide { float wide[]; };     // one float per pixel of the image with its margin: see margin.comp
writeonly buffer Blocks { uint words[]; };   // one uint per block
writeonly buffer Planes { vec4 planes[]; };  // by the sites' numbers
writeonly buffer List { uint list[]; };      // the sites' numbers, in no order
buffer Counts { SiteCounts counts; };        // zeros before

/// A pixel lies in a site's plane by this many pixels' widths. Error and time hardly change from .25 to .7.
const float kCovered = 0.64;

const int kPixels = kBlock * kBlock;

/// The order in which pixels become sites: those near the middle first.
const uint kOrder[kPixels] = uint[](5u, 10u, 6u, 9u, 0u, 15u, 3u, 12u, 1u, 14u, 2u, 13u, 4u, 11u, 7u, 8u);

/// Whether anybody needs the estimates of a block: its corners lie in up to four tiles.
bool is_needed(View view, ivec2 first) {
  const ivec2 tiles = tiles_of(view.size);
  const ivec2 from = max(first, ivec2(0)) / kTile, to = min(first + kBlock - 1, view.size - 1) / kTile;
  return (needed[from.y * tiles.x + from.x] | needed[from.y * tiles.x + to.x] | needed[to.y * tiles.x + from.x] |
          needed[to.y * tiles.x + to.x]) != 0u;
}

/// Lists the sites of a block. The invocation whose sites begin a workgroup counts it.
void list_sites(int number, uint count) {
  if (count == 0u) return;
  const uint group = kGroupX * kGroupY, at = atomicAdd(counts.listed, count), end = at + count;
  for (uint s = 0u; s < count; s++) list[at + s] = uint(number * kBlockSites) + s;
  if ((at + group - 1u) / group == (end + group - 1u) / group) return;
  const uvec2 groups = dispatch_of((end + group - 1u) / group);
  atomicMax(counts.groups.x, groups.x);
  atomicMax(counts.groups.y, groups.y);
}

void main() {
  const View view = params.view;
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy), first = block * kBlock - params.overhang;
  const int number = block.y * params.blocks.x + block.x, stride = view.size.x + 2 * kDepthMargin;
  if (block == ivec2(0)) counts.groups.z = 1u;
  if (any(greaterThanEqual(block, params.blocks))) return;
  Plane pixels[kPixels];
  uint left = 0u;  // the pixels that no site stands for, as bits by their order
  [[unroll]] for (int k = 0; k < kPixels; k++) {
    const ivec2 pixel = first + place_in_block(kOrder[k]);
    const int index = index_of(view, clamp(pixel, ivec2(0), view.size - 1));
    const float z = depth[index];
    pixels[k] = plane_of(view, pixel, z, unpack_normal(normal[index]));
    const bool exists = inside(view, pixel);
    if (exists) wide[(pixel.y + kDepthMargin) * stride + pixel.x + kDepthMargin] = z;
    left |= exists && z < kSkyDepth ? 1u << k : 0u;
  }
  if (kSelects != 0u) left = is_needed(view, first) ? left : 0u;
  uint word = 0u, count = 0u;
  int s = 0;
  do {
    const uint at = left != 0u ? uint(findLSB(left)) : uint(kPixels);
    Plane site = pixels[0];
    uint place = kOrder[0];
    // Chosen member by member: an index that is no constant would put the pixels into memory.
    [[unroll]] for (int k = 1; k < kPixels; k++) {
      const bool is = at == uint(k);
      site.z = is ? pixels[k].z : site.z;
      site.ahead = is ? pixels[k].ahead : site.ahead;
      site.across.x = is ? pixels[k].across.x : site.across.x;
      site.across.y = is ? pixels[k].across.y : site.across.y;
      site.scale = is ? pixels[k].scale : site.scale;
      site.n.x = is ? pixels[k].n.x : site.n.x;
      site.n.y = is ? pixels[k].n.y : site.n.y;
      site.n.z = is ? pixels[k].n.z : site.n.z;
      place = is ? kOrder[k] : place;
    }
    const bool exists = at < uint(kPixels);
    uint covered = exists ? 1u << at : 0u;
    [[unroll]] for (int k = 0; k < kPixels; k++) {
      const vec2 px = vec2(place_in_block(kOrder[k]) - place_in_block(place));
      covered |= similarity(site, pixels[k], px, 0.0) > kCovered ? 1u << k : 0u;
    }
    if (exists) planes[number * kBlockSites + s] = pack_plane(site);
    word |= exists ? place << (4 + 4 * s) : 0u;
    count += exists ? 1u : 0u;
    left &= ~covered;
  } while (++s < kBlockSites && left != 0u);
  words[number] = word | count;
  list_sites(number, count);
}
