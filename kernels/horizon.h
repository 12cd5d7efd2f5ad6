// Parameters, bindings and specialization of horizon.comp, and of horizon_layers, which is made of it.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HORIZON_H
#define ALCOVE_HORIZON_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kHorizonDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kHorizonNormal = 1;  // in: one uint per pixel, from prepare
// out: one float per pixel, visibility in [0, 1], 1 = open; the plane of the parameters
ALCOVE_CONSTANT uint kHorizonAo = 2;
// out: planes x, y, z of the mean open direction b in view space as 0.5 + 0.5 b; only with kWithBent
ALCOVE_CONSTANT uint kHorizonBent = 3;
ALCOVE_CONSTANT uint kHorizonList = 4;        // in: one uint per listed tile, from classify
ALCOVE_CONSTANT uint kHorizonCounts = 5;      // in: TileCounts
ALCOVE_CONSTANT uint kHorizonSites = 7;       // in: one uint per site, from list_sites; only if sparse
ALCOVE_CONSTANT uint kHorizonSiteCounts = 8;  // in: SiteCounts; only if sparse
// out: one float per pixel, the visibility that completed surfaces took; only with kWithCompleted
ALCOVE_CONSTANT uint kHorizonCompleted = 6;
ALCOVE_CONSTANT uint kHorizonHidden = 9;  // in: planes of hidden surfaces that may block, see GBuffer; with layers only
ALCOVE_CONSTANT uint kHorizonOccluders = 10;  // in: one float per pixel, depth of the first surfaces that may block

ALCOVE_CONSTANT uint kHorizonSlicesId = 0;  // specialization: slices per pixel
ALCOVE_CONSTANT uint kHorizonStepsId = 1;   // specialization: steps to each side of a slice
ALCOVE_CONSTANT uint kHorizonModeId = 2;    // specialization: one of kFalloff* of falloff.glsl, and kWith* or not
ALCOVE_CONSTANT uint kHorizonSparseId = 3;  // specialization: 1: only the sites of the list are estimated
// specialization: one of kThickness*, of what is not connected to the receiver, kCompletes* and kInSectors or not, and
// kHiddenSurface times as many surfaces as a pixel may have behind the first
ALCOVE_CONSTANT uint kHorizonSolidId = 4;

ALCOVE_CONSTANT uint kWithBent = 4;          // a bit beside kFalloff*: bent normals too
ALCOVE_CONSTANT uint kWithCompleted = 8;     // another one: what completed surfaces take, too
ALCOVE_CONSTANT uint kThicknessWidth = 0;    // as deep as wide
ALCOVE_CONSTANT uint kThicknessLength = 1;   // as HorizonParams says
ALCOVE_CONSTANT uint kThicknessEndless = 2;  // solid as far as the sphere of the radius
ALCOVE_CONSTANT uint kCompletesBorder = 4;   // a bit beside them: surfaces go on beyond the image's border
ALCOVE_CONSTANT uint kCompletesHidden = 8;   // another one: they go on behind what is nearer, if not kThicknessEndless
ALCOVE_CONSTANT uint kInSectors = 16;        // another one: all that blocks is counted in sectors, no horizon is exact
ALCOVE_CONSTANT uint kHiddenSurface = 32;

struct HorizonParams {
  View view;
  float radius;          // scene units
  float falloff_start;   // scene units, below the radius
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  float thickness;       // scene units, infinite allowed; 0: as deep as wide
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(HorizonParams)

ALCOVE_END
#endif
