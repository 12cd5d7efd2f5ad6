// Parameters and bindings of widen.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_WIDEN_H
#define ALCOVE_WIDEN_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kWidenDepth = 0;       // in: one float per pixel of `view`, planar depth
ALCOVE_CONSTANT uint kWidenNormal = 1;      // in: one uint per pixel of `view`, see normal.glsl
ALCOVE_CONSTANT uint kWidenFound = 2;       // in: one key per pixel of `wide`, from the first round of `warp`
ALCOVE_CONSTANT uint kWidenWideDepth = 3;   // out: one float per pixel of `wide`
ALCOVE_CONSTANT uint kWidenWideNormal = 4;  // out: one uint per pixel of `wide`

ALCOVE_CONSTANT uint kWidenStageId = 0;  // specialization: one of kWiden* below

ALCOVE_CONSTANT uint kWidenEmpty = 0;   // the margin is left open: all that other views see is behind it
ALCOVE_CONSTANT uint kWidenFilled = 1;  // the margin alone is written, with what was found

struct WidenParams {
  View view;
  View wide;
  ivec2 margin;  // px that `wide` has to the left of `view` and above it
};
ALCOVE_PARAMS(WidenParams)

ALCOVE_END
#endif
