// Gives every pixel of a surface a visibility, from the sites about it, along one axis; rows, then columns, make the
// separable filter.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of visibility at sites, depth, normals, and the words that say which pixels are sites.
// Out: as many planes. Where all is open it stays exactly 1; sky is 1.
//
// The steps have their numbers at the code:
//  1. The sites in reach of a run of pixels are found: of rows in the words of blocks; of columns, what rows have
//     made.
//  2. A site counts at a pixel as far as both show one surface (likeness.glsl), and by a parabola of their distance.
//  3. Sums over the sites are taken for each pixel.
//  4. The pixel takes its own place on the straight line that fits the sites best (W. S. Cleveland, "Robust Locally
//     Weighted Regression and Smoothing Scatterplots", 1979): a mean alone would be pulled to that side of an edge on
//     which there are sites.
//  5. Rows hand on that value and how much the sites weigh together, by which columns then weigh the rows. Rows write
//     nothing where no site is in reach, and say so in a bit per run.
// One invocation computes a run of pixels, and goes over the sites in reach of it. A subgroup goes on as long as one of
// its lanes has any: so those beside each other take rows that lie 4 apart, on which a wide lattice has as many.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/filters/filters.h"
#include "kernels/base/view.glsl"
#include "kernels/base/likeness.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const int kRadius = 8;   // pixels to each side, 1 to 8
layout(constant_id = 1) const uint kMode = 0;    // bits of kInterpolate*
layout(constant_id = 2) const int kPlanes = 1;   // how many planes; they share their weights
layout(constant_id = 3) const int kMoments = 0;  // those of them that are moments: the first ones
const bool kColumns = (kMode & kInterpolateColumns) != 0u;
const uint kByDepth = kMode & kInterpolateByDepth;
layout(scalar, push_constant) uniform Push { InterpolateParams params; };
// planes of floats in [0, 1], visibility or the like, at sites; of columns: what rows have made, see pack_blocked
readonly buffer Ao { uint ao[]; };
readonly buffer Depth { float depth[]; };    // one float per pixel, of the G-buffer of that visibility
readonly buffer Normal { uint normal[]; };   // one uint per pixel, of the same; not read with a depth sigma
writeonly buffer Result { uint result[]; };  // as many planes of all pixels, in [0, 1]; of rows: see pack_blocked
// a word for each run of a row and 32 rows, with a bit for each that is written; zeros before the rows
buffer Runs { uint runs[]; };
readonly buffer Blocks { uint words[]; };  // one uint per block, see blocks.glsl; not read along columns

const bool kReadsNormals = kByDepth == 0u;
#include "kernels/base/plane_at.glsl"

/// Pixels that one invocation looks at.
const int kCount = kDenoiseRun + 2 * kRadius;

/// A pixel takes sites from so many pixels away, however small the radius is: it has some there, see sites.comp.
const int kLeastReach = 3;

/// The slope of the line is held back by this, px^2: a spread of the sites this wide halves it. It keeps few sites, and
/// noisy ones, from a slope of their own.
const float kLeastSpread = 2.0;

/// Sums over the sites that a pixel has seen: of their weights, times their distance, times its square.
struct Sums {
  float whole, along, spread;
};

/// 5. The pixel's occlusion, and the weight of its sites together: rows hand both to columns. A weight that is
/// not 0 stays so, however small it is: it may be all that there is.
uint pack_blocked(float blocked, float weight) {
  const float least = weight > 0.0 ? 1.0 / 65535.0 : 0.0;
  return packUnorm2x16(vec2(blocked, max(sqrt(weight), least)));
}

float square(float x) { return x * x; }

/// The value of a plane where nothing is blocked.
float open_value(int p) { return p < kMoments ? 0.5 : 1.0; }

/// 1. The sites of a row from this pixel on, as bits.
uint sites_of_row(ivec2 first) {
  const SiteGrid grid = params.grid;
  const ivec2 at = first + grid.overhang;
  const int block = at.x >> 2, beside = at.x & 3, row = at.y / kBlock * grid.blocks.x;
  uint bits = 0u;
  for (int k = 0; k <= (kCount + 2) / kBlock; k++) {
    const bool exists = block + k >= 0 && block + k < grid.blocks.x;
    const uint word = exists ? words[row + clamp(block + k, 0, grid.blocks.x - 1)] : 0u;
    bits = with_row(bits, row_of_block(word, at.y % kBlock), k * kBlock - beside);
  }
  return bits;
}

/// 2. How a site weighs at a pixel so far away. It depends on nothing but the pixel and the distance, not even by
/// rounding, so that a pixel gets the same bits wherever its run begins. A kernel of the user's is looked up.
float window_at(float away, float narrowness) {
  if ((kMode & kInterpolateLooksUp) != 0u) return params.weight[min(int(abs(away)), kRadius)];
  precise const float window = 1.0 - narrowness * (away * away);
  return params.weight[0] * greater(window, kLeastWindow);
}

/// The narrowness of a pixel's parabola, which is 0 a pixel beyond its reach: no contact is smeared over more than a
/// part of the radius.
float narrowness_of(Plane plane) {
  const float end = 1.0 + clamp(params.reach / plane.scale, min(float(kLeastReach), params.most), params.most);
  return 1.0 / (end * end);
}

/// Makes the pixels of a run from these bits of those that the invocation looks at.
void interpolate(ivec2 first, uint sites, int plane) {
  Plane planes[kDenoiseRun];
  Sums sums[kDenoiseRun];
  float narrowness[kDenoiseRun];
  float value[kPlanes * kDenoiseRun], slope[kPlanes * kDenoiseRun];  // sums of what is blocked, and times the distance
  for (int i = 0; i < kDenoiseRun; i++) {
    planes[i] = plane_at(params.view, first + i * params.axis);
    sums[i] = Sums(0.0, 0.0, 0.0);
    narrowness[i] = narrowness_of(planes[i]);
    for (int p = 0; p < kPlanes; p++) value[p * kDenoiseRun + i] = slope[p * kDenoiseRun + i] = 0.0;
  }
  uint left = sites;
  do {
    const int j = findLSB(left) - kRadius;
    const ivec2 site = first + j * params.axis;
    const int index = index_of(params.view, site);
    const float weight = kColumns ? square(unpackUnorm2x16(ao[index]).y) : 1.0;
    const Plane there = plane_at(params.view, site);
    float blocked[kPlanes];
    for (int p = 0; p < kPlanes; p++) {
      const uint word = ao[index + p * plane];
      blocked[p] = kColumns ? unpackUnorm2x16(word).x : 1.0 - uintBitsToFloat(word);
    }
    for (int i = 0; i < kDenoiseRun; i++) {
      const float away = float(j - i);
      const float at = window_at(away, narrowness[i]);
      const float alike = kByDepth != 0u ? similarity_of_depths(planes[i], there, params.depth_sigma, kLeastSimilarity)
                                         : similarity(planes[i], there, away * vec2(params.axis), kLeastSimilarity);
      const float share = abs(away) <= float(kRadius) ? weight * at * alike : 0.0;
      // 3.
      sums[i].whole += share;
      sums[i].along += share * away;
      sums[i].spread += share * away * away;
      for (int p = 0; p < kPlanes; p++) {
        value[p * kDenoiseRun + i] += share * blocked[p];
        slope[p * kDenoiseRun + i] += share * away * blocked[p];
      }
    }
    left &= left - 1u;
  } while (left != 0u);
  for (int i = 0; i < kDenoiseRun; i++) {
    const ivec2 pixel = first + i * params.axis;
    if (!inside(params.view, pixel)) continue;
    const bool is_known = planes[i].z < kSkyDepth && sums[i].whole > 0.0;
    const float over = is_known ? 1.0 / sums[i].whole : 0.0;
    const float away = sums[i].along * over;
    // 4.
    const float spread = (sums[i].spread + kLeastSpread * sums[i].whole) - sums[i].along * away;
    // The variance of the line where the pixel is, against that where its sites are: rows of which they lie aside
    // weigh less in the columns.
    const float sureness = spread / max(spread + sums[i].along * away, 1e-30);
    for (int p = 0; p < kPlanes; p++) {
      const float mean = value[p * kDenoiseRun + i] * over;
      const float rise = (slope[p * kDenoiseRun + i] - sums[i].along * mean) / max(spread, 1e-30);
      const float blocked = is_known ? clamp(mean - rise * away, 0.0, 1.0) : 0.0;
      result[index_of(params.view, pixel) + p * plane] =
          kColumns ? floatBitsToUint(is_known ? 1.0 - blocked : open_value(p))
                   : pack_blocked(blocked, is_known ? sums[i].whole * sureness : 0.0);
    }
  }
}

/// The words of the runs in a row, of which each stands for a run in 32 rows: where it has a site in reach.
int words_of_runs() { return (params.view.size.x + kDenoiseRun - 1) / kDenoiseRun; }

/// 1. The rows from this pixel on that have a mean near it, as bits.
uint means_of_column(ivec2 first) {
  const int word = first.y >> 5, shift = first.y & 31;
  const int last = (params.view.size.y - 1) >> 5;
  const int run = min(first.x, params.view.size.x - 1) / kDenoiseRun;
  const uint low = word >= 0 && word <= last ? runs[word * words_of_runs() + run] : 0u;
  const uint high = word + 1 >= 0 && word + 1 <= last ? runs[(word + 1) * words_of_runs() + run] : 0u;
  return low >> uint(shift) | (shift > 0 ? high << uint(32 - shift) : 0u);
}

void main() {
  // Of 8 runs in 8 lines, those in every fourth line go together.
  const uint number = gl_LocalInvocationIndex / kGroupX;
  const uint lane = gl_LocalInvocationIndex % kGroupX;
  const uint in_group = kColumns ? number : (number / 4u) * 4u + lane % 4u;
  const uint in_lines = kColumns ? lane : number % 4u + lane / 4u * 4u;
  const int line = int(gl_WorkGroupID.x * kGroupX + in_lines), run = int(gl_WorkGroupID.y * kGroupY + in_group);
  const ivec2 first = line * params.axis.yx + kDenoiseRun * run * params.axis;
  if (any(greaterThanEqual(first, params.view.size))) return;

  const int plane = params.view.size.x * params.view.size.y;
  const ivec2 from = first - kRadius * params.axis;
  const uint sites = (kColumns ? means_of_column(from) : sites_of_row(from)) & ~0u >> uint(32 - kCount);
  if (sites != 0u) interpolate(first, sites, plane);
  if (!kColumns && sites != 0u) atomicOr(runs[(line >> 5) * words_of_runs() + run], 1u << uint(line & 31));
  if (kColumns && sites == 0u)
    for (int i = 0; i < kDenoiseRun * kPlanes; i++) {
      const ivec2 pixel = first + i % kDenoiseRun * params.axis;
      if (inside(params.view, pixel))
        result[index_of(params.view, pixel) + i / kDenoiseRun * plane] = floatBitsToUint(open_value(i / kDenoiseRun));
    }
}
