// Smooths the visibility of the sites of blocks among themselves, each surface by itself.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the words of blocks, the planes of sites, their visibility.
// Out: what is blocked at each site, and how that changes over the image.
//
// A site takes its place on the plane through the sites about it, as in fit_sites.comp: a plane through 5 x 5 blocks
// leaves a straight gradient as it is. Sites count by their distance, and by how far they lie in each other's planes.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/quick/quick.h"
#include "kernels/base/view.glsl"
#include "kernels/quick/blocks.glsl"

layout(local_size_x = 64) in;
layout(scalar, push_constant) uniform Push { BlocksParams params; };
readonly buffer Blocks { uint words[]; };   // from block_sites
readonly buffer Planes { vec4 planes[]; };  // from block_sites
readonly buffer List { uint list[]; };      // from block_sites
readonly buffer Counts { SiteCounts counts; };
readonly buffer Seen { float seen[]; };  // from quick_horizon
// by the sites' numbers: what is blocked, and by how much that grows per pixel to the right and below
writeonly buffer Fitted { vec4 fitted[]; };

// Blocks to each side, and the pixels from which on the second one counts: between sites of two blocks that are not
// neighbours lie at least 5.
const int kAround = 2;
const float kLeastToSecond = 5.0;

/// Pixels to the end of the weights, at most and at least.
const float kMostReach = 17.0, kLeastReach = 3.0;

/// The slopes of the plane are held back by this, px^2.
const float kLeastSpread = 8.0;

/// The least sum of weights, and determinant, that is divided by.
const float kTiny = 1e-20;

/// Weighted sums over sites.
struct Sums {
  float weight, blocked;
  vec2 px, rise;  // of the way to the site, and of that times what is blocked there
  float xx, xy, yy;
};

void add(inout Sums sums, float weight, float blocked, vec2 px) {
  sums.weight += weight;
  sums.blocked += weight * blocked;
  sums.px += weight * px;
  sums.rise += weight * blocked * px;
  sums.xx += weight * px.x * px.x;
  sums.xy += weight * px.x * px.y;
  sums.yy += weight * px.y * px.y;
}

/// The height of the plane at the site, and its slopes.
vec3 fit(Sums sums) {
  const float over = 1.0 / max(sums.weight, kTiny), mean = sums.blocked * over, held = kLeastSpread * sums.weight;
  const vec2 middle = sums.px * over, rise = sums.rise - sums.px * mean;
  const float xx = sums.xx + held - sums.px.x * middle.x, yy = sums.yy + held - sums.px.y * middle.y;
  const float xy = sums.xy - sums.px.x * middle.y;
  const vec2 slopes = vec2(yy * rise.x - xy * rise.y, xx * rise.y - xy * rise.x) / max(xx * yy - xy * xy, kTiny);
  return vec3(clamp(mean - dot(slopes, middle), 0.0, 1.0), slopes);
}

void main() {
  const ivec2 blocks = params.blocks;  // a copy, since lavapipe reads parameters anew in each round of a loop
  const bool perspective = params.view.orthographic == 0;
  const uint at = (gl_WorkGroupID.y * kListedRow + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (at >= counts.listed) return;
  const uint site = list[at];
  const int number = int(site) / kBlockSites;
  const ivec2 block = block_of(number, blocks), place = place_of_site(words[number], site % uint(kBlockSites));
  const Plane here = plane_of_site(params.view, planes[site]);
  const float reach = clamp(params.reach / (perspective ? here.z : 1.0), kLeastReach, kMostReach);
  const float narrow = 1.0 / (reach * reach);
  Sums sums = Sums(0.0, 0.0, vec2(0), vec2(0), 0.0, 0.0, 0.0);
  const int around = reach > kLeastToSecond ? kAround : 1;
  int y = -around;
  do {
    int x = -around;
    do {
      const ivec2 other = block + ivec2(x, y), there = clamp(other, ivec2(0), blocks - 1);
      const int o = there.y * blocks.x + there.x;
      const uint word = other == there ? words[o] : 0u;
      const uint count = sites_in(word);
      uint j = 0u;
      if (count > 0u) do {
          const uint from = uint(o * kBlockSites) + j;
          const Plane plane = plane_of_site(params.view, planes[from]);
          const vec2 px = vec2(ivec2(x, y) * kBlock + place_of_site(word, j) - place);
          const float alike = similarity(here, plane, px, 0.0);
          add(sums, greater(1.0 - narrow * dot(px, px), 0.0) * alike, 1.0 - seen[from], px);
        } while (++j < count);
    } while (++x <= around);
  } while (++y <= around);
  fitted[site] = vec4(fit(sums), 0.0);
}
