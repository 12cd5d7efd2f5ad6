// Parameters and bindings of surfels.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SURFELS_H
#define ALCOVE_SURFELS_H
#include "reprojection.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kSurfelsDepth = 0;   // in: one float per pixel, planar depth
ALCOVE_CONSTANT uint kSurfelsNormal = 1;  // in: one uint per pixel, see normal.glsl
ALCOVE_CONSTANT uint kSurfelsFlags = 2;   // in: one uint per pixel, from `still`
ALCOVE_CONSTANT uint kSurfelsUse = 3;  // out: one uint per pixel, 0 or one of kFlagMoves, kFlagUnconfirmed, kFlagUnfit

// specialization: 0 or 1: what no other view confirms is not used
ALCOVE_CONSTANT uint kSurfelsConfirmedId = 0;

struct SurfelsParams {
  View view;
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};
ALCOVE_PARAMS(SurfelsParams)

ALCOVE_END
#endif
