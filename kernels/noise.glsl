// Low-discrepancy sample noise over a 64 x 64 tile of pixels. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Neighbours along a Hilbert curve take successive points of the R2 sequence (M. Roberts, "The unreasonable
// effectiveness of quasirandom sequences", 2018), so any small block of pixels holds a well spread set.

const vec2 kR2 = vec2(kR2X, kR2Y);
const vec2 kRoots = vec2(kRootX, kRootY);
const float kGolden = 0.61803398874989485;  // (sqrt(5) - 1) / 2

/// Position along the Hilbert curve that fills a 64 x 64 tile.
uint hilbert_index(uvec2 p) {
  p &= 63u;
  uint index = 0u;
  for (uint level = 32u; level > 0u; level >>= 1) {
    const uvec2 quadrant = uvec2(notEqual(p & level, uvec2(0)));
    index += level * level * ((3u * quadrant.x) ^ quadrant.y);
    if (quadrant.y == 0u) {
      if (quadrant.x == 1u) p = 63u - p;
      p = p.yx;
    }
  }
  return index;
}

/// Two numbers in [0, 1) for a pixel, each a lattice over the tile; `shift` moves the whole pattern (frame and seed).
vec2 pixel_noise(ivec2 pixel, vec2 shift) {
  const vec2 p = vec2(pixel & 63);
  return fract(shift + vec2(dot(p, kR2), dot(p, kRoots)));
}

/// Point `index` of the R3 sequence (the same in three dimensions, g^4 = g + 1), moved by `shift`, in [0, 1). Where
/// every pixel has n samples, those from n hilbert_index() on go on where the neighbour's ended. It is computed in
/// whole numbers, since floats have too few digits for it.
vec3 r3_point(uint index, vec2 shift) {
  const uvec3 step = uvec3(3518319155u, 2882110345u, 2360945575u);  // 2^32 / g, / g^2, / g^3
  return fract(vec3(index * step >> 8) / 16777216.0 + vec3(shift, shift.x + shift.y));
}
