// Lists the sites of the listed tiles, and counts them by their lattices.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the words of tiles, see tiles.glsl, and the tiles that classify has listed.
// Out: the sites, of every workgroup's tiles those of the widest lattice first, and how many there are.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ListSitesParams params; };
readonly buffer Rows { uint rows[]; };    // 8 words per tile, see tiles.glsl
readonly buffer Tiles { uint tiles[]; };  // one uint per listed tile
readonly buffer TileCountsBuffer { TileCounts tile_counts; };
writeonly buffer List { uint list[]; };  // one uint per site of a listed tile, see pack_site; in no order of tiles
buffer Counts { SiteCounts counts; };    // zeros before

/// The numbers of sites that the workgroup lists, their first place in the list, and the number of each lattice. Those
/// of the widest lattice come first, so that neighbours in the list take as many slices.
shared uint wide_here, others_here, begin, of_lattice[kLattices];

void main() {
  if (gl_LocalInvocationIndex == 0u) wide_here = others_here = 0u;
  if (gl_LocalInvocationIndex < kLattices) of_lattice[gl_LocalInvocationIndex] = 0u;
  barrier();
  const uint number =
      (gl_WorkGroupID.y * kListedRow + gl_WorkGroupID.x) * (kGroupX * kGroupY) + gl_LocalInvocationIndex;
  const bool is_listed = number < tile_counts.listed;
  const ivec2 tile = is_listed ? unpack_tile(tiles[number]) : ivec2(0);
  const int words = words_of_tile(tile, tiles_of(params.size));
  uint wide[2] = uint[2](0u, 0u), others[2] = uint[2](0u, 0u), within[kLattices];
  for (uint k = 0u; k < kLattices; k++) within[k] = 0u;
  for (int y = 0; y < kTile && is_listed; y++) {
    const uint row = rows[words + y] >> kSiteByte;
    const ivec2 first = tile * kTile + ivec2(0, y) + params.origin;
    const uint widest = row & lattice_row(first, 16), shift = uint(y % 4 * kTile);
    wide[y / 4] |= widest << shift;
    others[y / 4] |= (row & ~widest) << shift;
    for (uint k = 0u; k < kLattices; k++) within[k] += bitCount(row & lattice_row(first, 16 >> k));
  }
  uint at_wide = 0u, at_others = 0u;
  if (is_listed) at_wide = atomicAdd(wide_here, within[0]);
  if (is_listed) at_others = atomicAdd(others_here, within[kLattices - 1u] - within[0]);
  for (uint k = 0u; k < kLattices; k++)
    if (is_listed) atomicAdd(of_lattice[k], within[k] - (k > 0u ? within[k - 1u] : 0u));
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    const uint listed_here = wide_here + others_here;
    begin = atomicAdd(counts.listed, listed_here);
    const uvec2 groups = dispatch_of((begin + listed_here + kGroupX * kGroupY - 1u) / (kGroupX * kGroupY));
    atomicMax(counts.groups.x, groups.x);
    atomicMax(counts.groups.y, groups.y);
    atomicMax(counts.groups.z, 1u);
  }
  if (gl_LocalInvocationIndex < kLattices)
    atomicAdd(counts.of_lattice[gl_LocalInvocationIndex], of_lattice[gl_LocalInvocationIndex]);
  barrier();
  at_wide += begin;
  at_others += begin + wide_here;
  for (uint half_tile = 0u; half_tile < 2u; half_tile++) {
    const uint first = pack_site(number, 32u * half_tile);
    for (uint left = wide[half_tile]; left != 0u; left &= left - 1u)
      list[at_wide++] = kWideSite | first + uint(findLSB(left));
    for (uint left = others[half_tile]; left != 0u; left &= left - 1u) list[at_others++] = first + uint(findLSB(left));
  }
}
