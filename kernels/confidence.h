// Parameters and bindings of confidence.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_CONFIDENCE_H
#define ALCOVE_CONFIDENCE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kConfidenceDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kConfidenceNormal = 1;  // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kConfidenceThin = 2;    // in: one float per pixel, visibility where occluders are thin
ALCOVE_CONSTANT uint kConfidenceSolid = 3;   // in: one float per pixel, visibility where they are endless
// in: one float per pixel, visibility where they are thin, and surfaces are completed as the settings say
ALCOVE_CONSTANT uint kConfidenceCompleted = 5;
ALCOVE_CONSTANT uint kConfidenceResult = 4;  // out: one float per pixel, 0 to 1; 1 for sky

struct ConfidenceParams {
  View view;
  float radius;          // scene units
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(ConfidenceParams)

ALCOVE_END
#endif
