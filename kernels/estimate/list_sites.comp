// Lists the sites of the listed tiles, and counts them by their lattices.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the words of blocks, see blocks.glsl, and the tiles that classify has listed.
// Out: the sites, and how many there are.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/tiles.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ListSitesParams params; };
readonly buffer Blocks { uint words[]; };  // one uint per block
readonly buffer Tiles { uint tiles[]; };   // one uint per listed tile
readonly buffer TileCountsBuffer { TileCounts tile_counts; };
writeonly buffer List { uint list[]; };  // one uint per site of a listed tile, see pack_site; in no order of tiles
buffer Counts { SiteCounts counts; };    // zeros before

/// The sites of a row of a tile, as bits.
uint sites_of_row(ivec2 first) {
  const SiteGrid grid = params.grid;
  const ivec2 at = first + grid.overhang, block = at / kBlock, beside = at % kBlock;
  uint bits = 0u;
  for (int k = 0; k <= kTile / kBlock && first.y < params.size.y; k++)
    if (block.x + k < grid.blocks.x)
      bits =
          with_row(bits, row_of_block(words[block.y * grid.blocks.x + block.x + k], beside.y), k * kBlock - beside.x);
  return bits & (1u << uint(kTile)) - 1u;
}

/// The number of sites that the workgroup lists, their first place in the list, and the number of each lattice.
shared uint here, begin, of_lattice[kLattices];

void main() {
  if (gl_LocalInvocationIndex == 0u) here = 0u;
  if (gl_LocalInvocationIndex < kLattices) of_lattice[gl_LocalInvocationIndex] = 0u;
  barrier();
  const uint number =
      (gl_WorkGroupID.y * kListedRow + gl_WorkGroupID.x) * (kGroupX * kGroupY) + gl_LocalInvocationIndex;
  const bool is_listed = number < tile_counts.listed;
  const ivec2 tile = is_listed ? unpack_tile(tiles[number]) : ivec2(0);
  uint sites[2] = uint[2](0u, 0u), within[kLattices];
  for (uint k = 0u; k < kLattices; k++) within[k] = 0u;
  for (int y = 0; y < kTile && is_listed; y++) {
    const ivec2 pixel = tile * kTile + ivec2(0, y);
    const uint row = sites_of_row(pixel);
    sites[y / 4] |= row << uint(y % 4 * kTile);
    const ivec2 first = pixel + params.origin;
    for (uint k = 0u; k < kLattices; k++) within[k] += bitCount(row & lattice_row(first, 16 >> k));
  }
  uint at = 0u;
  if (is_listed) at = atomicAdd(here, within[kLattices - 1u]);
  for (uint k = 0u; k < kLattices; k++)
    if (is_listed) atomicAdd(of_lattice[k], within[k] - (k > 0u ? within[k - 1u] : 0u));
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    begin = atomicAdd(counts.listed, here);
    const uvec2 groups = dispatch_of((begin + here + kGroupX * kGroupY - 1u) / (kGroupX * kGroupY));
    atomicMax(counts.groups.x, groups.x);
    atomicMax(counts.groups.y, groups.y);
    atomicMax(counts.groups.z, 1u);
  }
  if (gl_LocalInvocationIndex < kLattices)
    atomicAdd(counts.of_lattice[gl_LocalInvocationIndex], of_lattice[gl_LocalInvocationIndex]);
  barrier();
  at += begin;
  for (uint half_tile = 0u; half_tile < 2u; half_tile++) {
    const uint first = pack_site(number, 32u * half_tile);
    for (uint left = sites[half_tile]; left != 0u; left &= left - 1u) list[at++] = first + uint(findLSB(left));
  }
}
