// Smooths what is known at the sites of blocks among themselves, each surface by itself.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the words of blocks, the planes and the list of sites; planes of visibility or the like, at sites.
// Out: what is blocked at each site, and how that changes over the image. Where all is open it stays exactly 0.
//
// A site takes its own place on the plane, over the image, that fits the sites of 5 x 5 blocks best (W. S. Cleveland,
// "Robust Locally Weighted Regression and Smoothing Scatterplots", 1979): a mean alone would be pulled to that side of
// an edge on which there are sites. They count as far as they show one surface (likeness.glsl), by a parabola of their
// distance, and no farther than a part of the radius.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const int kPlanes = 1;  // how many planes from the first one on; they share their weights
layout(scalar, push_constant) uniform Push { FitBlocksParams params; };
readonly buffer Blocks { uint words[]; };   // from sites
readonly buffer Planes { vec4 planes[]; };  // from sites
readonly buffer List { uint list[]; };      // from sites
readonly buffer Counts { SiteCounts counts; };
readonly buffer Ao { float ao[]; };          // planes of floats in [0, 1], visibility or the like, at sites
writeonly buffer Fitted { uint fitted[]; };  // as many planes, by the sites' numbers, two words each: see pack_fit

// Blocks to each side, and the pixels from which on the second one counts: between sites of two blocks that are not
// neighbours lie at least 5.
const int kAround = 2;
const float kLeastToSecond = 5.0;

/// Where a block has more sites than this, as in hair, those of its neighbours are enough.
const int kFewSites = 2;

/// Pixels to the end of the weights, at least.
const float kLeastReach = 3.0;

/// The least sum of weights, and determinant, that is divided by.
const float kTiny = 1e-20;

/// Sums over the sites about one: of their weights, times the way to them, and times its products; of what they block,
/// and of that times the way.
struct Sums {
  float weight, xx, xy, yy;
  vec2 px;
  float blocked[kPlanes];
  vec2 rise[kPlanes];
};

void write(int number, int all, Sums sums) {
  const float over = 1.0 / max(sums.weight, kTiny), held = params.held * sums.weight;
  const vec2 middle = sums.px * over;
  const float xx = sums.xx + held - sums.px.x * middle.x, yy = sums.yy + held - sums.px.y * middle.y;
  const float xy = sums.xy - sums.px.x * middle.y, per_determinant = 1.0 / max(xx * yy - xy * xy, kTiny);
  [[unroll]] for (int p = 0; p < kPlanes; p++) {
    const float mean = sums.blocked[p] * over;
    const vec2 rise = sums.rise[p] - sums.px * mean;
    const vec2 slopes = vec2(yy * rise.x - xy * rise.y, xx * rise.y - xy * rise.x) * per_determinant;
    const uvec2 packed = pack_fit(vec3(clamp(mean - dot(slopes, middle), 0.0, 1.0), slopes));
    const int at = 2 * ((params.first + p) * all + number);
    fitted[at] = packed.x;
    fitted[at + 1] = packed.y;
  }
}

void main() {
  // Copies, since lavapipe reads parameters anew in each round of a loop.
  const View view = params.view;
  const SiteGrid grid = params.grid;
  const uint at = (gl_WorkGroupID.y * kListedRow + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (at >= counts.listed) return;
  const int number = int(list[at]), own_block = number % (grid.blocks.x * grid.blocks.y);
  const ivec2 site = pixel_of_site(grid, number), block = (site + grid.overhang) / kBlock;
  const int width = view.size.x, plane_size = width * view.size.y, begin = params.first * plane_size;
  const Plane here = unpack_plane(view, planes[number]);
  const float reach = clamp(params.reach / here.scale, kLeastReach, params.most);
  const float narrow = 1.0 / (reach * reach);
  Sums sums;
  sums.weight = sums.xx = sums.xy = sums.yy = 0.0;
  sums.px = vec2(0);
  [[unroll]] for (int p = 0; p < kPlanes; p++) {
    sums.blocked[p] = 0.0;
    sums.rise[p] = vec2(0);
  }
  const int around = reach > kLeastToSecond && bitCount(words[own_block]) <= kFewSites ? kAround : 1;
  int y = -around;
  do {
    int x = -around;
    do {
      const ivec2 other = block + ivec2(x, y), there = clamp(other, ivec2(0), grid.blocks - 1);
      const int o = there.y * grid.blocks.x + there.x;
      uint left = other == there ? words[o] : 0u;
      const vec2 away = vec2(other * kBlock - grid.overhang - site);
      const int corner = begin + index_of(view, other * kBlock - grid.overhang);
      if (left != 0u) do {
          const int bit = findLSB(left);
          const ivec2 place = place_in_block(bit);
          left &= left - 1u;
          const vec2 px = away + vec2(place);
          const int index = corner + place.y * width + place.x;
          const float alike = similarity(here, unpack_plane(view, planes[number_of_site(grid, o, bit)]), px, 0.0);
          const float weight = greater(1.0 - narrow * dot(px, px), 0.0) * alike;
          sums.weight += weight;
          sums.px += weight * px;
          sums.xx += weight * px.x * px.x;
          sums.xy += weight * px.x * px.y;
          sums.yy += weight * px.y * px.y;
          [[unroll]] for (int p = 0; p < kPlanes; p++) {
            const float blocked = weight * (1.0 - ao[index + p * plane_size]);
            sums.blocked[p] += blocked;
            sums.rise[p] += blocked * px;
          }
        } while (left != 0u);
    } while (++x <= around);
  } while (++y <= around);
  write(number, grid.blocks.x * grid.blocks.y * kBlockPixels, sums);
}
