// Gives every pixel of a surface the moments of the sites about it.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of moments at sites, depth, normals, and the words that say which pixels are sites; those of the widest
// lattice may have been smoothed among themselves before, see fit_sites.comp.
// Out: as many planes. Where nothing is blocked, and on sky, they are 1/2.
//
// interpolate.comp would do it as well at three times the cost. Directions vary less than the visibility does, which it
// brings to every pixel: a mean is enough, over sites of one surface by a tent of their distance. One invocation
// computes a cell of the lattice, whose pixels share what is loaded.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kPlanes = 3;    // how many planes
layout(constant_id = 2) const int kMoments = 3;   // those of them that are moments: the first ones
layout(constant_id = 1) const uint kFitted = 0u;  // 1: those of the lattice were smoothed
layout(scalar, push_constant) uniform Push { SpreadParams params; };
readonly buffer Moments { float moments[]; };  // planes of floats in [0, 1], see moments.glsl, at sites
readonly buffer Depth { float depth[]; };      // one float per pixel, of the G-buffer of the estimate
readonly buffer Normal { uint normal[]; };     // one uint per pixel, of the same
readonly buffer Fitted { float fitted[]; };    // planes of the lattice's pixels, from fit_sites; only with kFitted
readonly buffer Sites { uint rows[]; };        // 8 words per tile, see tiles.glsl
writeonly buffer Result { float result[]; };   // as many planes of all pixels

const bool kReadsNormals = true;
#include "kernels/base/plane_at.glsl"

const int kCell = kLatticeStep * kLatticeStep;  // pixels

/// The pixels to each side of a cell whose sites count for it, and those that it looks at in a row.
const int kMargin = 2, kAcross = kLatticeStep + 2 * kMargin;

/// The tent ends so many pixels from a site: beyond the next one of the lattice.
const float kTent = float(kSpreadReach) + 0.5;

/// A site that was not smoothed weighs so much beside one that was.
const float kNoisySite = 0.4;

/// The sites among the pixels of a row from this one on, as bits.
uint sites_of_row(ivec2 first) {
  const ivec2 tiles = tiles_of(params.view.size);
  if (first.y < 0 || first.y >= params.view.size.y) return 0u;
  uint bits = 0u;
  for (int k = 0; k < 2; k++) {
    const int tile = (first.x >> 3) + k, shift = 8 * k - (first.x & 7);
    const bool exists = tile >= 0 && tile < tiles.x;
    const uint row =
        rows[words_of_tile(ivec2(clamp(tile, 0, tiles.x - 1), first.y / kTile), tiles) + first.y % kTile] >> kSiteByte;
    if (exists) bits |= shift < 0 ? row >> uint(-shift) : row << uint(shift);
  }
  return bits & (1u << uint(kAcross)) - 1u;
}

void main() {
  const View view = params.view;
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, params.sites))) return;
  const ivec2 corner = params.first + kLatticeStep * cell;
  const int plane = view.size.x * view.size.y;
  Plane here[kCell];
  float whole[kCell], sum[kCell * kPlanes];
  for (int i = 0; i < kCell; i++) {
    here[i] = plane_at(view, corner + ivec2(i % kLatticeStep, i / kLatticeStep));
    whole[i] = 0.0;
    for (int p = 0; p < kPlanes; p++) sum[i * kPlanes + p] = 0.0;
  }
  // The sites of the upper and of the lower half of what the cell looks at, as bits.
  uvec2 left = uvec2(0);
  for (int j = 0; j < kAcross; j++)
    left[j / 4] |= sites_of_row(corner + ivec2(-kMargin, j - kMargin)) << uint(j % 4 * kAcross);
  if ((left.x | left.y) != 0u) {
    do {
      const bool is_upper = left.x != 0u;
      const int bit = is_upper ? findLSB(left.x) : findLSB(left.y) + 32;
      left = is_upper ? uvec2(left.x & left.x - 1u, left.y) : uvec2(0, left.y & left.y - 1u);
      const ivec2 beside = ivec2(bit % kAcross, bit / kAcross) - kMargin, site = corner + beside;
      const int index = index_of(view, site);
      const bool is_smooth = kFitted != 0u && ((beside.x | beside.y) & (kLatticeStep - 1)) == 0;
      const ivec2 of_lattice = min(cell + beside / kLatticeStep, params.sites - 1);
      const Plane there = plane_at(view, site);
      const float weight = there.z >= kSkyDepth ? 0.0 : kFitted == 0u || is_smooth ? 1.0 : kNoisySite;
      float value[kPlanes];
      for (int p = 0; p < kPlanes; p++) {
        value[p] = moments[index + p * plane];
        if (is_smooth) value[p] = fitted[(p * params.sites.y + of_lattice.y) * params.sites.x + of_lattice.x];
      }
      for (int i = 0; i < kCell; i++) {
        const vec2 away = vec2(beside - ivec2(i % kLatticeStep, i / kLatticeStep));
        const vec2 tent = max(1.0 - abs(away) * (1.0 / kTent), 0.0);
        const float share = weight * tent.x * tent.y * similarity(here[i], there, away, kLeastSimilarity);
        whole[i] += share;
        for (int p = 0; p < kPlanes; p++) sum[i * kPlanes + p] += share * value[p];
      }
    } while ((left.x | left.y) != 0u);
  }
  for (int i = 0; i < kCell; i++) {
    const ivec2 pixel = corner + ivec2(i % kLatticeStep, i / kLatticeStep);
    if (!inside(view, pixel)) continue;
    const bool is_known = whole[i] > 0.0 && here[i].z < kSkyDepth;
    for (int p = 0; p < kPlanes; p++)
      result[index_of(view, pixel) + p * plane] = is_known ? sum[i * kPlanes + p] / whole[i] : p < kMoments ? 0.5 : 1.0;
  }
}
