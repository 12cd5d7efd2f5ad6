// Parameters and bindings of horizon.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HORIZON_H
#define ALCOVE_HORIZON_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kHorizonDepth = 0;   // in: float a pixel, from prepare
ALCOVE_CONSTANT uint kHorizonNormal = 1;  // in: uint a pixel, from prepare
ALCOVE_CONSTANT uint kHorizonAo = 2;      // out: float a pixel, visibility in [0, 1], 1 = open

ALCOVE_CONSTANT uint kHorizonSlicesId = 0;   // specialization: slices a pixel
ALCOVE_CONSTANT uint kHorizonStepsId = 1;    // specialization: steps to each side of a slice
ALCOVE_CONSTANT uint kHorizonFalloffId = 2;  // specialization: one of kFalloff*

ALCOVE_CONSTANT uint kFalloffNone = 0;       // whatever is nearer than the radius blocks
ALCOVE_CONSTANT uint kFalloffLinear = 1;     // from 1 at the start to 0 at the radius
ALCOVE_CONSTANT uint kFalloffQuadratic = 2;  // 1 - x^2
ALCOVE_CONSTANT uint kFalloffSmooth = 3;     // 1 - smoothstep

struct HorizonParams {
  View view;
  float radius;         // scene units
  float falloff_start;  // scene units, below the radius
  ivec2 noise_origin;   // px: what to add to a pixel so that crops and tiles share one noise pattern
  vec2 noise_shift;     // in [0, 1): the pattern's shift for this frame and seed
};
ALCOVE_PARAMS(HorizonParams)

ALCOVE_END
#endif
