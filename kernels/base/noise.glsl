// Low-discrepancy sample noise. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Slices turn by a lattice over the image: a number that grows by the same fraction of a turn from pixel to pixel. What
// an estimate errs by is then, on a plain surface, a sum of waves: harmonic (k, l) of the two numbers is a wave of k
// times the first one's frequency and l times the second one's, less whole ones. The fractions are chosen so that on
// every lattice of tiles.glsl the harmonics that weigh most are waves so short that the filters take them away. The
// weights were measured: on plain surfaces of rendered scenes seven tenths of the variance is the first harmonic of the
// slices' direction, and hardly any is the steps'. See docs/lab.md.

const float kGolden = 0.61803398874989485;  // (sqrt(5) - 1) / 2

// Fractions of a turn, times 2^32.
const uint kNoiseXByX = 850015508u, kNoiseXByY = 2573490380u;  // 0.1979097, 0.5991874
const uint kNoiseYByX = 518391397u, kNoiseYByY = 584904276u;   // 0.1206974, 0.1361836

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
