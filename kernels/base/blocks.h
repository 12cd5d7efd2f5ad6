// Blocks of 4 x 4 pixels, in which sites are chosen: pixels with an estimate of their own.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BLOCKS_H
#define ALCOVE_BLOCKS_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT int kBlock = 4;  // px a side

/// The blocks of an image. They are counted from the display window's corner, so that a crop has those of the whole.
struct SiteGrid {
  ivec2 overhang;  // px of the first block to the left of the image and above it
  ivec2 blocks;    // in x and y
};

ALCOVE_END
#endif
