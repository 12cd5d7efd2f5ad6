// Blocks of pixels, and their sites. Pure: no bindings; to be included after view.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// Blocks are counted from the display window's corner, so that a crop has those of the whole. The word of a block has,
// from the lowest bits on, the number of its sites in 4 bits, and for each of them 4 bits with its place, row by row.
// A site has the number of its block times kBlockSites, and its own in the block.
#include "kernels/base/likeness.glsl"

/// The normal's z follows from its x and y, since it faces the eye.
vec4 pack_plane(Plane plane) { return vec4(plane.z, plane.ahead, plane.n.xy); }
Plane plane_of_site(View view, vec4 packed) {
  const vec2 xy = packed.zw, pixel = view.tangent_per_pixel;
  const float scale = view.orthographic == 0 ? packed.x : 1.0;
  const vec3 n = vec3(xy, sqrt(max(1.0 - dot(xy, xy), 0.0)));
  return Plane(packed.x, scale, packed.y, xy * (pixel / (abs(pixel.x) * scale)), n);
}

uint sites_in(uint word) { return word & 15u; }

ivec2 place_in_block(uint place) { return ivec2(int(place & 3u), int(place >> 2)); }

ivec2 place_of_site(uint word, uint site) { return place_in_block(word >> (4u + 4u * site) & 15u); }

ivec2 block_of(int number, ivec2 blocks) { return ivec2(number % blocks.x, number / blocks.x); }
