// Parameters and bindings of receivers.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_RECEIVERS_H
#define ALCOVE_RECEIVERS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kReceiversMatte = 0;  // in: one float per pixel of the frame, from matte
ALCOVE_CONSTANT uint kReceiversTiles = 1;  // in and out: one uint per tile of the image, zeros

ALCOVE_CONSTANT uint kReceiversFactorId = 0;  // specialization: px of a block in x and in y

struct ReceiversParams {
  ivec2 size;        // px of the image: its blocks
  ivec2 frame_size;  // px
  ivec2 offset;      // px from the frame's corner to that of the image's first block
  int reach;         // tiles about one with receivers whose estimates these need
};
ALCOVE_PARAMS(ReceiversParams)

ALCOVE_END
#endif
