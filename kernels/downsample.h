// Parameters and bindings of downsample.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DOWNSAMPLE_H
#define ALCOVE_DOWNSAMPLE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDownsampleDepth = 0;      // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kDownsampleNormal = 1;     // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kDownsampleLowDepth = 2;   // out: one float per block, kSkyDepth where all of it is sky
ALCOVE_CONSTANT uint kDownsampleLowNormal = 3;  // out: one uint per block
ALCOVE_CONSTANT uint kDownsampleHidden = 4;     // in: planes of hidden surfaces, see GBuffer; none if there are none
ALCOVE_CONSTANT uint kDownsampleLowHidden = 5;  // out: as many of the blocks

ALCOVE_CONSTANT uint kDownsampleFactorId = 0;  // specialization: pixels of a block in x and in y

struct DownsampleParams {
  View view;       // of the pixels
  ivec2 low_size;  // blocks
  ivec2 overhang;  // px: how far the first block reaches beyond the left and upper border
  uint hidden;     // planes of hidden surfaces
};
ALCOVE_PARAMS(DownsampleParams)

ALCOVE_END
#endif
