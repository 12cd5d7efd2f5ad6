// Parameters and bindings of bounds.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BOUNDS_H
#define ALCOVE_BOUNDS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kBoundsDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kBoundsHidden = 1;  // in: planes of hidden surfaces, see GBuffer
// out: nearest and farthest depth per block of tiles, rows of blocks from the upper left corner; nothing hidden:
// kSkyDepth, 0
ALCOVE_CONSTANT uint kBoundsBlocks = 2;

struct BoundsParams {
  ivec2 size;   // px, of the image
  uint hidden;  // planes of hidden surfaces
};
ALCOVE_PARAMS(BoundsParams)

ALCOVE_END
#endif
