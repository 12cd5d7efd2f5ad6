// Blocks of pixels, and their sites. Pure: no bindings; to be included after view.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// Blocks are counted from the display window's corner, so that a crop has those of the whole. The word of a block has,
// from the lowest bits on, the number of its sites in 4 bits, and for each of them 4 bits with its place, row by row.
// A site has the number of its block times kBlockSites, and its own in the block.
#include "kernels/base/likeness.glsl"

/// A unit normal's z follows from its x and y, and a sign, which that of the depth keeps.
vec4 pack_plane(Plane plane) { return vec4(plane.n.z < 0.0 ? -plane.z : plane.z, plane.ahead, plane.n.xy); }
Plane plane_of_site(View view, vec4 packed) {
  const vec2 xy = packed.zw;
  const float z = abs(packed.x), scale = view.orthographic == 0 ? z : 1.0, up = sqrt(max(1.0 - dot(xy, xy), 0.0));
  const vec3 n = vec3(xy, packed.x < 0.0 ? -up : up);
  return Plane(z, scale, packed.y, xy * (view.tangent_per_pixel / width_at(view, scale)), n);
}

uint sites_in(uint word) { return word & 15u; }

ivec2 place_in_block(uint place) { return ivec2(int(place & 3u), int(place >> 2)); }

ivec2 place_of_site(uint word, uint site) { return place_in_block(word >> (4u + 4u * site) & 15u); }

ivec2 block_of(int number, ivec2 blocks) { return ivec2(number % blocks.x, number / blocks.x); }
