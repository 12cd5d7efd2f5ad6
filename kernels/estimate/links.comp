// Says of every pixel whether it and its neighbours are one surface, and makes the surfaces on a lattice and, if it
// is adaptive, on the image's border sites.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: the words of every tile of 8 x 8 pixels, see tiles.glsl.
//
// Two neighbours are one surface if the filters take them for one (likeness.glsl), and without a bend if they are so
// alike that pixels further on are, too. An invocation computes a tile, row by row, so that each pixel is read once.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kSpacing = 8;  // of the lattice whose surfaces are sites, 1 to 16
// 1: says what is one surface; 0: that nothing is, for sites that do not depend on it
layout(constant_id = 1) const uint kAdaptive = 1;
layout(scalar, push_constant) uniform Push { LinksParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
writeonly buffer Rows { uint rows[]; };     // 8 words per tile, see tiles.glsl
// the same, of which two bytes are written: linked without a bend; only if adaptive
writeonly buffer Flat { uint flat_rows[]; };

/// Neighbours are one surface if the filters give one so much of the other's weight at least.
const float kLinked = 0.9;

/// On a round surface the weight lost grows with the square of the distance between the pixels. Neighbours are linked
/// without a bend if those 3 pixels apart are linked still.
const float kFlat = 1.0 - (1.0 - kLinked) / 9.0;

Plane plane_at(View view, ivec2 at) {
  const ivec2 nearest = min(at, view.size - 1);
  const int index = index_of(view, nearest);
  const float z = at == nearest ? depth[index] : kSkyDepth;
  if (kAdaptive == 0u) return Plane(z, 1.0, 0.0, vec2(0), vec3(0));
  return plane_of(view, nearest, z, unpack_normal(normal[index]));
}

/// How far neighbours are one surface. px: from a to b.
float link(Plane a, Plane b, vec2 px) {
  return kAdaptive != 0u && max(a.z, b.z) < kSkyDepth ? similarity(a, b, px, 0.0) : 0.0;
}

/// The sites of a row of a tile on the image's border, as bits: every second pixel of it. Beyond the last row or column
/// of the lattice pixels would else have sites on one side only, and the border would be a dotted line.
uint border_sites(ivec2 first) {
  const ivec2 last = params.view.size - 1 - first, from_corner = first + params.origin;
  const uint row = first.y == 0 || last.y == 0 ? lattice_row(ivec2(from_corner.x, 0), 8) : 0u;
  const uint ends = (first.x == 0 ? 1u : 0u) | (last.x < kTile ? 1u << uint(last.x) : 0u);
  return (row | ((from_corner.y & 1) == 0 ? ends : 0u)) & (1u << uint(kTile)) - 1u;
}

void main() {
  const View view = params.view;
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy), tiles = tiles_of(view.size);
  if (any(greaterThanEqual(tile, tiles))) return;
  const ivec2 first = tile * kTile;
  const int words = words_of_tile(tile, tiles);
  Plane above[kTile];
  uint word = 0u, flat_word = 0u;
  int y = 0;
  do {
    Plane taps[kTile + 1];
    for (int x = 0; x <= kTile; x++) taps[x] = plane_at(view, first + ivec2(x, y));
    uint below = 0u, flat_below = 0u, right = 0u, flat_right = 0u, surface = 0u;
    for (int x = 0; x < kTile; x++) {
      const float down = y > 0 ? link(above[x], taps[x], vec2(0, 1)) : 0.0;
      const float across = link(taps[x], taps[x + 1], vec2(1, 0));
      below |= down > kLinked ? 1u << x : 0u;
      flat_below |= down > kFlat ? 1u << x : 0u;
      right |= across > kLinked ? 1u << x : 0u;
      flat_right |= across > kFlat ? 1u << x : 0u;
      surface |= taps[x].z < kSkyDepth ? 1u << x : 0u;
      above[x] = taps[x];
    }
    if (y > 0) rows[words + y - 1] = word | below << kBelowByte;
    if (y > 0 && kAdaptive != 0u) flat_rows[words + y - 1] = flat_word | flat_below << kBelowByte;
    const uint lattice = lattice_row(first + ivec2(0, y) + params.origin, kSpacing);
    const uint border = kAdaptive != 0u ? border_sites(first + ivec2(0, y)) : 0u;
    const uint site = surface & (lattice | border);
    word = right | surface << kSurfaceByte | site << kSiteByte;
    flat_word = flat_right;
  } while (++y <= kTile);
}
