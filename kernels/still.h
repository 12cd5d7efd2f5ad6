// Parameters and bindings of still.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_STILL_H
#define ALCOVE_STILL_H
#include "reprojection.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kStillDepth = 0;         // in: one float per pixel of `from`, planar depth
ALCOVE_CONSTANT uint kStillNormal = 1;        // in: one uint per pixel of `from`, see normal.glsl
ALCOVE_CONSTANT uint kStillWitnessDepth = 2;  // in: one float per pixel of `to`, planar depth
// in and out: one uint per pixel of `from`: kFlagConfirmed and kFlagSeenThrough, zeroed before the first view
ALCOVE_CONSTANT uint kStillFlags = 3;

struct StillParams {
  Reprojection by;
};
ALCOVE_PARAMS(StillParams)

ALCOVE_END
#endif
