// Parameters and bindings of reconstruct.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_RECONSTRUCT_H
#define ALCOVE_RECONSTRUCT_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kReconstructDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kReconstructNormal = 1;  // in and out: one uint per pixel, see normal.glsl: all face the eye
ALCOVE_CONSTANT uint kReconstructCounts = 2;  // in and out: FrameCounts

struct ReconstructParams {
  View view;
};
ALCOVE_PARAMS(ReconstructParams)

ALCOVE_END
#endif
