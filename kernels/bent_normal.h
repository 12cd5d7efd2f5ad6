// Parameters and bindings of bent_normal.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BENT_NORMAL_H
#define ALCOVE_BENT_NORMAL_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kBentNormalNormal = 0;  // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kBentNormalBent = 1;    // in: planes x, y, z of the mean open direction b as 0.5 + 0.5 b
ALCOVE_CONSTANT uint kBentNormalResult = 2;  // out: one uint per pixel, as the normal

struct BentNormalParams {
  ivec2 size;  // px
};
ALCOVE_PARAMS(BentNormalParams)

ALCOVE_END
#endif
