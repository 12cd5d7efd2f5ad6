// Parameters and bindings of combine.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COMBINE_H
#define ALCOVE_COMBINE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCombineScales = 0;  // in: planes of visibility in [0, 1], one per radius
ALCOVE_CONSTANT uint kCombineAo = 1;      // out: one float per pixel, visibility in [0, 1]

struct CombineParams {
  ivec2 size;  // px
  uint count;  // planes
};
ALCOVE_PARAMS(CombineParams)

ALCOVE_END
#endif
