// Parameters and bindings of the estimators that search slices: horizon.comp, bitmask.comp, and both with layers.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SLICES_H
#define ALCOVE_SLICES_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kSlicesDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kSlicesNormal = 1;  // in: one uint per pixel, from prepare
// out: one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
ALCOVE_CONSTANT uint kSlicesAo = 2;
// out: planes x, y, z of the mean open direction b in view space as 0.5 + 0.5 b; only with kWithBent
ALCOVE_CONSTANT uint kSlicesBent = 3;
ALCOVE_CONSTANT uint kSlicesList = 4;        // in: one uint per listed tile, from classify
ALCOVE_CONSTANT uint kSlicesCounts = 5;      // in: TileCounts
ALCOVE_CONSTANT uint kSlicesSites = 7;       // in: one uint per site, from list_sites; only if sparse
ALCOVE_CONSTANT uint kSlicesSiteCounts = 8;  // in: SiteCounts; only if sparse
// out: one float per pixel, the visibility that completed surfaces took; only with kWithCompleted
ALCOVE_CONSTANT uint kSlicesCompleted = 6;
ALCOVE_CONSTANT uint kSlicesHidden = 9;  // in: planes of hidden surfaces that may block, see GBuffer; with layers only
ALCOVE_CONSTANT uint kSlicesOccluders = 10;  // in: one float per pixel, depth of the first surfaces that may block

struct SlicesParams {
  View view;
  float radius;          // scene units
  float falloff_start;   // scene units, below the radius
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  float thickness;       // scene units; infinite allowed; horizon: with kThicknessLength; bitmask: 0: as deep as wide
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(SlicesParams)

ALCOVE_END
#endif
