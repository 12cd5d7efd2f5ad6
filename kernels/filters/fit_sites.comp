// Smooths the visibility of the sites of the widest lattice among themselves, each surface by itself.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility at sites, depth, normals.
// Out: as many planes of the lattice's pixels. Where all is open it stays exactly 1.
//
// A site takes its own place on the plane, over the image, that fits the sites about it best (W. S. Cleveland, "Robust
// Locally Weighted Regression and Smoothing Scatterplots", 1979): a mean alone would be pulled to that side of an edge
// on which there are sites. They count as far as they show one surface (likeness.glsl), by a parabola of their
// distance, and no farther than a part of the radius. One invocation computes some in a row, which share what they
// load.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kPlanes = 1;  // how many planes; they share their weights
layout(scalar, push_constant) uniform Push { FitSitesParams params; };
readonly buffer Ao { float ao[]; };           // planes of floats in [0, 1], visibility or the like, at sites
readonly buffer Depth { float depth[]; };     // one float per pixel, of the G-buffer of that visibility
readonly buffer Normal { uint normal[]; };    // one uint per pixel, of the same
writeonly buffer Result { float result[]; };  // as many planes, one float per pixel of the lattice

/// Sites to each side.
const int kReach = kFitReach / kLatticeStep;

/// The slopes of the plane are held back by this, px^2: a spread of the sites this wide halves them.
const float kLeastSpread = 4.0;

const uint kByDepth = 0u;
#include "kernels/filters/taps.glsl"

/// Sums over the sites about one: of their weights, times the distance, and times its products; of what they block, and
/// of that times the distance.
struct Sums {
  float whole, xx, xy, yy;
  vec2 along, slope[kPlanes];
  float value[kPlanes];
};

void write(ivec2 site, Sums s) {
  const float over = s.whole > 0.0 ? 1.0 / s.whole : 0.0;
  const vec2 middle = s.along * over;
  const float xx = s.xx + kLeastSpread * s.whole - s.along.x * middle.x;
  const float yy = s.yy + kLeastSpread * s.whole - s.along.y * middle.y;
  const float xy = s.xy - s.along.x * middle.y;
  const float scale = 1.0 / max(xx * yy - xy * xy, 1e-30);
  for (int p = 0; p < kPlanes; p++) {
    const float mean = s.value[p] * over;
    const vec2 rise = s.slope[p] - s.along * mean;
    const vec2 slope = scale * vec2(yy * rise.x - xy * rise.y, xx * rise.y - xy * rise.x);
    result[(p * params.sites.y + site.y) * params.sites.x + site.x] = 1.0 - clamp(mean - dot(slope, middle), 0.0, 1.0);
  }
}

void main() {
  const View view = params.view;
  const ivec2 site = ivec2(gl_GlobalInvocationID.xy) * ivec2(kFitRun, 1), sites = params.sites;
  if (any(greaterThanEqual(site, sites))) return;
  const ivec2 pixel = site * kLatticeStep + params.first, most = view.size - 1;
  const int plane = view.size.x * view.size.y;
  Plane here[kFitRun];
  float narrowness[kFitRun];
  Sums sums[kFitRun];
  for (int i = 0; i < kFitRun; i++) {
    here[i] = plane_at(view, pixel + ivec2(i * kLatticeStep, 0));
    const float end = min(float(kFitReach), params.reach / here[i].scale) + 0.5 * float(kLatticeStep);
    narrowness[i] = 1.0 / (end * end);
    sums[i].whole = sums[i].xx = sums[i].xy = sums[i].yy = 0.0;
    sums[i].along = vec2(0);
    for (int p = 0; p < kPlanes; p++) {
      sums[i].value[p] = 0.0;
      sums[i].slope[p] = vec2(0);
    }
  }
  int y = -kReach;
  do {
    int x = -kReach;
    do {
      const ivec2 other = pixel + kLatticeStep * ivec2(x, y), nearest = clamp(other, ivec2(0), most);
      const Plane plane_there = plane_at(view, other);
      const bool is_site = plane_there.z < kSkyDepth;
      const float exists = is_site ? 1.0 : 0.0;
      float blocked[kPlanes];  // what is no site was never written: 0 times it need not be 0
      for (int p = 0; p < kPlanes; p++) blocked[p] = is_site ? 1.0 - ao[index_of(view, nearest) + p * plane] : 0.0;
      for (int i = 0; i < kFitRun; i++) {
        const vec2 away = float(kLatticeStep) * vec2(x - i, y);
        precise const float window = greater(exists - narrowness[i] * dot(away, away), 0.0);
        const float share = window * similarity(here[i], plane_there, away, 0.0);
        sums[i].whole += share;
        sums[i].along += share * away;
        sums[i].xx += share * away.x * away.x;
        sums[i].xy += share * away.x * away.y;
        sums[i].yy += share * away.y * away.y;
        for (int p = 0; p < kPlanes; p++) {
          sums[i].value[p] += share * blocked[p];
          sums[i].slope[p] += share * blocked[p] * away;
        }
      }
    } while (++x < kReach + kFitRun);
  } while (++y <= kReach);
  for (int i = 0; i < kFitRun; i++)
    if (site.x + i < sites.x) write(site + ivec2(i, 0), sums[i]);
}
