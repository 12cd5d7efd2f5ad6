// Says of every pixel whether it and its neighbours are one surface, and makes the surfaces on a lattice and, if it
// is adaptive, on the image's border sites.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals.
// Out: the words of every tile of 8 x 8 pixels, see tiles.glsl.
//
// Two neighbours are one surface if each lies in the plane of the other, by the distance that the filters take; and
// without a bend if it lies there so nearly that pixels further on do, too. An
// invocation computes a tile, row by row, so that each pixel is read once.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/view.glsl"
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

/// Neighbours are one surface if neither lies further from the other's plane than this many pixels are wide there. The
/// filters give such a neighbour 0.9 of its weight.
const float kLinked = 0.3;

/// On a round surface the distance grows with the square of that between the pixels. Neighbours are linked without a
/// bend if those 3 pixels apart still count in the filters: this part of kLinked.
const float kFlat = 0.33;

struct Tap {
  float z;
  float scale;  // scene units per unit of tangent_of(): z, or 1 where the view is orthographic
  vec2 pixel;   // scene units: kLinked of a pixel, in x and y
  float ahead;  // height above this tap's plane of what is a unit further away
  vec2 across;  // of what is a pixel to the right, or below, at scale 1
};

Tap load(View view, ivec2 at) {
  Tap tap = Tap(kSkyDepth, 1.0, vec2(0), 0.0, vec2(0));
  const ivec2 nearest = min(at, view.size - 1);
  const int index = index_of(view, nearest);
  tap.z = at == nearest ? depth[index] : kSkyDepth;
  if (kAdaptive == 0u) return tap;
  const bool perspective = view.orthographic == 0;
  const vec3 n = unpack_normal(normal[index]);
  tap.scale = perspective ? tap.z : 1.0;
  tap.pixel = kLinked * tap.scale * abs(view.tangent_per_pixel);
  tap.ahead = (perspective ? dot(n.xy, tangent_of(view, vec2(nearest) + 0.5)) : 0.0) - n.z;
  tap.across = n.xy * view.tangent_per_pixel;
  return tap;
}

/// The distances of two neighbours from each other's planes, the larger of both, in kLinked pixels; axis: 0: b is to
/// the right of a, 1: below.
float bend(Tap a, Tap b, int axis) {
  const float further = b.z - a.z;
  const float above_a = abs(a.ahead * further + a.across[axis] * b.scale);
  const float above_b = abs(b.ahead * further + b.across[axis] * a.scale);
  return max(a.z, b.z) < kSkyDepth ? max(above_a / a.pixel[axis], above_b / b.pixel[axis]) : 1.0;
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
  Tap above[kTile];
  uint word = 0u, flat_word = 0u;
  int y = 0;
  do {
    Tap taps[kTile + 1];
    for (int x = 0; x <= kTile; x++) taps[x] = load(view, first + ivec2(x, y));
    uint below = 0u, flat_below = 0u, right = 0u, flat_right = 0u, surface = 0u;
    for (int x = 0; x < kTile; x++) {
      const float down = kAdaptive != 0u && y > 0 ? bend(above[x], taps[x], 1) : 1.0;
      const float across = kAdaptive != 0u ? bend(taps[x], taps[x + 1], 0) : 1.0;
      below |= down < 1.0 ? 1u << x : 0u;
      flat_below |= down < kFlat ? 1u << x : 0u;
      right |= across < 1.0 ? 1u << x : 0u;
      flat_right |= across < kFlat ? 1u << x : 0u;
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
