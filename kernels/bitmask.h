// Parameters and bindings of bitmask.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BITMASK_H
#define ALCOVE_BITMASK_H
#include "horizon.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kBitmaskDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kBitmaskNormal = 1;  // in: one uint per pixel, from prepare
// out: one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
ALCOVE_CONSTANT uint kBitmaskAo = 2;
// out: planes x, y, z of the mean open direction b in view space as 0.5 + 0.5 b; only with kWithBent
ALCOVE_CONSTANT uint kBitmaskBent = 3;
ALCOVE_CONSTANT uint kBitmaskList = 4;        // in: one ListedTile per tile, from classify: what to estimate
ALCOVE_CONSTANT uint kBitmaskCounts = 5;      // in: TileCounts
ALCOVE_CONSTANT uint kBitmaskSites = 7;       // in: one uint per site, from list_sites; only if sparse
ALCOVE_CONSTANT uint kBitmaskSiteCounts = 8;  // in: SiteCounts; only if sparse
// out: one float per pixel, the visibility that completed surfaces took; only with kWithCompleted
ALCOVE_CONSTANT uint kBitmaskCompleted = 6;
ALCOVE_CONSTANT uint kBitmaskHidden = 9;  // in: planes of hidden surfaces, see GBuffer; with more than one surface

ALCOVE_CONSTANT uint kBitmaskSlicesId = 0;    // specialization: slices per pixel
ALCOVE_CONSTANT uint kBitmaskStepsId = 1;     // specialization: steps to each side of a slice
ALCOVE_CONSTANT uint kBitmaskModeId = 2;      // specialization: one of kFalloff* of falloff.glsl, and kWith* or not
ALCOVE_CONSTANT uint kBitmaskSparseId = 3;    // specialization: 1: only the sites of the list are estimated
ALCOVE_CONSTANT uint kBitmaskCompleteId = 4;  // specialization: bits of kCompletes* of horizon.h, and kHiddenSurface

struct BitmaskParams {
  View view;
  float radius;          // scene units
  float falloff_start;   // scene units, below the radius
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  float thickness;       // scene units; infinite allowed; 0: as deep as wide
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(BitmaskParams)

ALCOVE_END
#endif
