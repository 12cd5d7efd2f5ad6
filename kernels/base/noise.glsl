// Low-discrepancy sample noise. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Slices turn by a lattice over the image: a number that grows by the same fraction of a turn from pixel to pixel. On a
// plain surface the error of an estimate is then a sum of waves: harmonic (k, l) of the two numbers is a wave of k
// times the first number's frequency plus l times the second one's, modulo 1. The fractions (kNoiseXByX ... of
// shared.h) make the heaviest harmonics so short on every lattice of tiles.glsl that the filters remove them. Measured
// weights: on plain surfaces of rendered scenes the first harmonic of the slices' direction has seven tenths of the
// variance, and the steps have hardly any. See docs/lab.md.

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

/// Two numbers in [0, 1) for a pixel, each a lattice over the image; `shift` moves the whole pattern (frame and seed).
/// They are computed in whole numbers, so that they are exact at any distance.
vec2 pixel_noise(ivec2 pixel, vec2 shift) {
  const uvec2 turns = uint(pixel.x) * uvec2(kNoiseXByX, kNoiseYByX) + uint(pixel.y) * uvec2(kNoiseXByY, kNoiseYByY);
  return fract(shift + vec2(turns >> 8) / 16777216.0);
}

/// Point `index` of the R3 sequence (the same in three dimensions, g^4 = g + 1), moved by `shift`, in [0, 1). Where
/// every pixel has n samples, those from n hilbert_index() on go on where the neighbour's ended. It is computed in
/// whole numbers, since floats have too few digits for it.
vec3 r3_point(uint index, vec2 shift) {
  const uvec3 step = uvec3(3518319155u, 2882110345u, 2360945575u);  // 2^32 / g, / g^2, / g^3
  return fract(vec3(index * step >> 8) / 16777216.0 + vec3(shift, shift.x + shift.y));
}
