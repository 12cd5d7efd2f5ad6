// Chooses the sites of each block of 4 x 4 pixels, and lists them.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, needed tiles.
// Out: the words of blocks, see blocks.glsl; the planes and the list of sites; depth with a margin.
//
// Surfaces on a lattice are sites. Where the density is adaptive, each site stands for the pixels of its block that
// show its surface (likeness.glsl) no farther away than a part of the radius, in which AO changes. With kEdges, the
// first site of a block that shows several surfaces stands only for the pixels beside it: AO changes fast there. One
// of the others is the next site, until none is left. A filter by rows, and then by columns, must find a way from the
// site to the pixel: where the pixel's column meets the site's row there is no sky. An invocation computes a block.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kSelects = 0;   // 1: only blocks of needed tiles have sites
layout(constant_id = 1) const uint kAdaptive = 1;  // 0: only the lattice has sites
layout(constant_id = 2) const uint kWidens = 0;    // 1: copies the depth
layout(constant_id = 3) const uint kEdges = 0;     // 1: sites are dense at edges; only if adaptive
layout(scalar, push_constant) uniform Push { SitesParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };   // one uint per pixel, from prepare
readonly buffer Needed { uint needed[]; };   // one uint per tile; only if it selects
writeonly buffer Wide { float wide[]; };     // one float per pixel of the image with its margin: see margin.comp
writeonly buffer Blocks { uint words[]; };   // one uint per block
writeonly buffer Planes { vec4 planes[]; };  // by the sites' numbers, see pack_plane; only if adaptive
writeonly buffer List { uint list[]; };      // the sites' numbers, in no order
buffer Counts { SiteCounts counts; };        // zeros before

/// A site stands for a pixel that is at least so alike: on a plane, one less than .6 pixels' widths off. Error and time
/// hardly change from .25 to .7.
const float kCovered = 0.64;

/// At an edge the first site stands for pixels so near, squared: its eight neighbours. The same of other sites brings
/// little (docs/lab.md).
const float kBesideSq = 2.0;

/// The order in which pixels become sites: first that of the widest lattice, then others near the middle.
const int kOrder[kBlockPixels] = int[](5, 10, 6, 9, 0, 15, 3, 12, 1, 14, 2, 13, 4, 11, 7, 8);

/// Whether anybody needs the estimates of a block: its corners lie in up to four tiles.
bool is_needed(View view, ivec2 first) {
  const ivec2 tiles = tiles_of(view.size);
  const ivec2 from = max(first, ivec2(0)) / kTile, to = min(first + kBlock - 1, view.size - 1) / kTile;
  return (needed[from.y * tiles.x + from.x] | needed[from.y * tiles.x + to.x] | needed[to.y * tiles.x + from.x] |
          needed[to.y * tiles.x + to.x]) != 0u;
}

/// Lists the sites of a block, which has this number. The invocation whose sites begin a workgroup counts it.
void list_sites(int block, uint sites) {
  if (sites == 0u) return;
  const uint count = uint(bitCount(sites)), group = kGroupX * kGroupY;
  const uint begin = atomicAdd(counts.listed, count), end = begin + count;
  for (uint at = begin; at < end; at++, sites &= sites - 1u)
    list[at] = uint(number_of_site(params.grid, block, findLSB(sites)));
  if ((begin + group - 1u) / group == (end + group - 1u) / group) return;
  const uvec2 groups = dispatch_of((end + group - 1u) / group);
  atomicMax(counts.groups.x, groups.x);
  atomicMax(counts.groups.y, groups.y);
}

void main() {
  const View view = params.view;
  const SiteGrid grid = params.grid;
  const ivec2 block = ivec2(gl_GlobalInvocationID.xy), first = block * kBlock - grid.overhang;
  const int number = block.y * grid.blocks.x + block.x, stride = view.size.x + 2 * kDepthMargin;
  if (block == ivec2(0)) counts.groups.z = 1u;
  if (any(greaterThanEqual(block, grid.blocks))) return;
  Plane pixels[kBlockPixels];
  uint left = 0u, lattice = 0u;  // the pixels that no site stands for, and those of the lattice, as bits by their order
  uint surfaces = 0u;            // as bits row by row
  [[unroll]] for (int k = 0; k < kBlockPixels; k++) {
    const ivec2 pixel = first + place_in_block(kOrder[k]);
    const int index = index_of(view, clamp(pixel, ivec2(0), view.size - 1));
    const float z = depth[index];
    pixels[k] = plane_of(view, pixel, z, kAdaptive != 0u ? unpack_normal(normal[index]) : vec3(0));
    const bool exists = inside(view, pixel);
    if (kWidens != 0u && exists) wide[(pixel.y + kDepthMargin) * stride + pixel.x + kDepthMargin] = z;
    const bool is_surface = exists && z < kSkyDepth;
    left |= is_surface ? 1u << k : 0u;
    surfaces |= is_surface ? 1u << kOrder[k] : 0u;
    lattice |= (params.lattice >> kOrder[k] & 1u) << k;
  }
  if (kSelects != 0u) left = is_needed(view, first) ? left : 0u;
  if (kAdaptive == 0u) left &= lattice;
  const uint seen = left;
  uint sites = 0u;
  if (left != 0u) do {
      const int at = findLSB(left);
      Plane site = pixels[0];
      int place = kOrder[0];
      // Chosen member by member: an index that is no constant would put the pixels into memory.
      [[unroll]] for (int k = 1; k < kBlockPixels; k++) {
        const bool is = at == k;
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
      const uint row = surfaces >> (place & ~3);  // of the site, in the lowest bits
      const float reach = params.reach / site.scale;
      uint alike = 0u, near = 0u, beside = 0u;
      [[unroll]] for (int k = 0; k < kBlockPixels && kAdaptive != 0u; k++) {
        const vec2 px = vec2(place_in_block(kOrder[k]) - place_in_block(place));
        const uint way = row >> (kOrder[k] & 3) & 1u;
        alike |= similarity(site, pixels[k], px, 0.0) > kCovered ? way << k : 0u;
        near |= dot(px, px) <= reach * reach ? 1u << k : 0u;
        beside |= dot(px, px) <= kBesideSq ? 1u << k : 0u;
      }
      uint covered = alike & near;
      if (kEdges != 0u && sites == 0u && (seen & ~alike) != 0u) covered &= beside;
      if (kAdaptive != 0u) planes[number_of_site(grid, number, place)] = pack_plane(site);
      sites |= 1u << place;
      left &= ~(covered & ~lattice | 1u << at);
    } while (left != 0u);
  words[number] = sites;
  list_sites(number, sites);
}
