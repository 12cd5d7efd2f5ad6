// Blocks of pixels, their sites, and how alike two pixels are. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Blocks are counted from the display window's corner, so that a crop has those of the whole. The word of a block has,
// from the lowest bits on, the number of its sites in 4 bits, and for each of them 4 bits with its place, row by row.
// A site has the number of its block times kBlockSites, and its own in the block.

/// A pixel's plane, by the height of others above it, in pixels' widths.
struct Plane {
  float z;      // planar depth of the pixel
  float ahead;  // height of what is a unit further away
  vec2 across;  // height of what is a pixel aside, at unit depth (orthographic: at any)
};

Plane plane_of(View view, ivec2 pixel, float z, vec3 n) {
  const bool perspective = view.orthographic == 0;
  const float per_width = 1.0 / (view.tangent_per_pixel.x * (perspective ? z : 1.0));
  const float toward = perspective ? dot(n.xy, tangent_of(view, vec2(pixel) + 0.5)) : 0.0;
  return Plane(z, (toward - n.z) * per_width, n.xy * view.tangent_per_pixel * per_width);
}

/// The square of how far two pixels lie from each other's planes, the larger of both, in pixels' widths. px: from a
/// to b.
float apart_sq(Plane a, Plane b, vec2 px, bool perspective) {
  const float further = b.z - a.z;
  const float above_a = a.ahead * further + dot(a.across, px) * (perspective ? b.z : 1.0);
  const float above_b = b.ahead * further + dot(b.across, px) * (perspective ? a.z : 1.0);
  return greater(above_a * above_a, above_b * above_b);
}

Plane plane_of_site(vec4 packed) { return Plane(packed.x, packed.y, packed.zw); }
vec4 pack_plane(Plane plane) { return vec4(plane.z, plane.ahead, plane.across); }

uint sites_in(uint word) { return word & 15u; }

ivec2 place_in_block(uint place) { return ivec2(int(place & 3u), int(place >> 2)); }

ivec2 place_of_site(uint word, uint site) { return place_in_block(word >> (4u + 4u * site) & 15u); }

ivec2 block_of(int number, ivec2 blocks) { return ivec2(number % blocks.x, number / blocks.x); }
