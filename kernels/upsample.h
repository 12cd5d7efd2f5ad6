// Parameters and bindings of upsample.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_UPSAMPLE_H
#define ALCOVE_UPSAMPLE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kUpsampleDepth = 0;      // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kUpsampleNormal = 1;     // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kUpsampleLowDepth = 2;   // in: one float per block, from downsample
ALCOVE_CONSTANT uint kUpsampleLowNormal = 3;  // in: one uint per block, from downsample
// in: planes of floats in [0, 1] a block, visibility or the like; each by itself
ALCOVE_CONSTANT uint kUpsampleLowAo = 4;
ALCOVE_CONSTANT uint kUpsampleAo = 5;  // out: as many planes, in [0, 1]

ALCOVE_CONSTANT uint kUpsampleList = 6;    // in: one uint per workgroup, from dilate; only with kUpsampleListedId
ALCOVE_CONSTANT uint kUpsampleCounts = 7;  // in: RunCounts of it

ALCOVE_CONSTANT uint kUpsampleFactorId = 0;  // specialization: pixels of a block in x and in y
ALCOVE_CONSTANT uint kUpsamplePlanesId = 1;  // specialization: how many planes; they share their weights
ALCOVE_CONSTANT uint kUpsampleListedId = 2;  // specialization: 1: only workgroups of the list; 0: all

struct UpsampleParams {
  View view;       // of the pixels
  ivec2 low_size;  // blocks
  ivec2 overhang;  // px: how far the first block reaches beyond the left and upper border
};
ALCOVE_PARAMS(UpsampleParams)

ALCOVE_END
#endif
