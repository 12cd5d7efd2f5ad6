// Parameters and bindings of crytek.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_CRYTEK_H
#define ALCOVE_CRYTEK_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCrytekDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kCrytekNormal = 1;  // in: one uint per pixel, from prepare
// out: one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
ALCOVE_CONSTANT uint kCrytekAo = 2;
ALCOVE_CONSTANT uint kCrytekList = 3;        // in: one uint per listed tile, from classify
ALCOVE_CONSTANT uint kCrytekCounts = 4;      // in: TileCounts
ALCOVE_CONSTANT uint kCrytekSites = 5;       // in: one uint per site, from list_sites; only if sparse
ALCOVE_CONSTANT uint kCrytekSiteCounts = 6;  // in: SiteCounts; only if sparse
ALCOVE_CONSTANT uint kCrytekOccluders = 7;   // in: one float per pixel, depth of the first surfaces that may block

ALCOVE_CONSTANT uint kCrytekSamplesId = 0;  // specialization: samples per pixel
ALCOVE_CONSTANT uint kCrytekSparseId = 1;   // specialization: 1: only the sites of the list are estimated

ALCOVE_CONSTANT uint kRangeNone = 0;   // every hit counts fully
ALCOVE_CONSTANT uint kRangeRatio = 1;  // smoothstep(0, 1, radius / dz): fully within the radius, less beyond
// 1 - smoothstep(0, radius, dz): less from the receiver on, nothing beyond the radius
ALCOVE_CONSTANT uint kRangeSmoothstep = 2;

struct CrytekParams {
  View view;
  float radius;          // scene units
  float bias;            // scene units: by how much a hit must be nearer to the eye than the sample
  uint uniform_volume;   // 1: samples even in volume; 0: clustered about the receiver
  uint range_check;      // one of kRange*
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(CrytekParams)

ALCOVE_END
#endif
