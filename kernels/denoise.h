// Parameters and bindings of denoise.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DENOISE_H
#define ALCOVE_DENOISE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDenoiseAo = 0;      // in: planes of floats in [0, 1], visibility or the like; each by itself
ALCOVE_CONSTANT uint kDenoiseDepth = 1;   // in: one float per pixel, of the G-buffer of that visibility
ALCOVE_CONSTANT uint kDenoiseNormal = 2;  // in: one uint per pixel, of the same; not read with a depth sigma
ALCOVE_CONSTANT uint kDenoiseResult = 3;  // out: as many planes, in [0, 1]

ALCOVE_CONSTANT uint kDenoiseList = 4;    // in: one uint per run, from dilate; only if listed
ALCOVE_CONSTANT uint kDenoiseCounts = 5;  // in: RunCounts of it

ALCOVE_CONSTANT uint kDenoiseRadiusId = 0;   // specialization: pixels to each side, 1 to kDenoiseMostRadius
ALCOVE_CONSTANT uint kDenoiseByDepthId = 1;  // specialization: 1: weighs by depth_sigma instead of by plane distance

ALCOVE_CONSTANT uint kDenoiseListedId = 2;  // specialization: 1: only the runs of the list, not all
ALCOVE_CONSTANT uint kDenoisePlanesId = 3;  // specialization: how many planes; they share their weights

ALCOVE_CONSTANT int kDenoiseMostRadius = 8;  // px
ALCOVE_CONSTANT int kDenoiseRun = 12;        // px along the axis that one invocation computes

struct DenoiseParams {
  View view;
  ivec2 axis;         // (1, 0): along rows; (0, 1): along columns
  float depth_sigma;  // of the depth: a step by this part of it weighs 1/e
  float weight[9];    // by the distance in pixels, 0 to the radius; of any sum
};
ALCOVE_PARAMS(DenoiseParams)

ALCOVE_END
#endif
