// Parameters and bindings of needed.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_NEEDED_H
#define ALCOVE_NEEDED_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kNeededMatte = 0;  // in: one float per pixel of the frame, from matte
ALCOVE_CONSTANT uint kNeededTiles = 1;  // in and out: one uint per tile of the image, zeros

ALCOVE_CONSTANT uint kNeededFactorId = 0;  // specialization: px of a block in x and in y

struct NeededParams {
  ivec2 size;        // px of the image: its blocks
  ivec2 frame_size;  // px
  ivec2 offset;      // px from the frame's corner to that of the image's first block
  int reach;         // px of the image about a receiver whose estimates it needs
};
ALCOVE_PARAMS(NeededParams)

ALCOVE_END
#endif
