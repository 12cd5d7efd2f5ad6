// Parameters and bindings of hbao.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HBAO_H
#define ALCOVE_HBAO_H
#include "horizon.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kHbaoDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kHbaoNormal = 1;  // in: one uint per pixel, from prepare
// out: one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
ALCOVE_CONSTANT uint kHbaoAo = 2;
ALCOVE_CONSTANT uint kHbaoList = 3;        // in: one uint per listed tile, from classify
ALCOVE_CONSTANT uint kHbaoCounts = 4;      // in: TileCounts
ALCOVE_CONSTANT uint kHbaoSites = 5;       // in: one uint per site, from list_sites; only if sparse
ALCOVE_CONSTANT uint kHbaoSiteCounts = 6;  // in: SiteCounts; only if sparse
ALCOVE_CONSTANT uint kHbaoOccluders = 7;   // in: one float per pixel, depth of the first surfaces that may block

ALCOVE_CONSTANT uint kHbaoSlicesId = 0;   // specialization: lines through a pixel, each searched to both sides
ALCOVE_CONSTANT uint kHbaoStepsId = 1;    // specialization: steps to each side
ALCOVE_CONSTANT uint kHbaoFalloffId = 2;  // specialization: one of kFalloff* of falloff.glsl, the attenuation W
ALCOVE_CONSTANT uint kHbaoSparseId = 3;   // specialization: 1: only the sites of the list are estimated

struct HbaoParams {
  View view;
  float radius;         // scene units
  float falloff_start;  // scene units, below the radius
  float bias;           // sine of the elevation above the tangent plane below which nothing blocks
  // 1: the horizon's elevation above the surface; 0: of horizon and surface above the plane across the view ray
  uint from_surface;
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(HbaoParams)

ALCOVE_END
#endif
