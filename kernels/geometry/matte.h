// Parameters of the kernels that core/chain/geometry/matte.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_MATTE_H
#define ALCOVE_MATTE_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kMatteCoverage = 0;  // one plane of it
ALCOVE_CONSTANT uint kMatteNumbers = 1;   // one plane of objects
ALCOVE_CONSTANT uint kMatteRanked = 2;    // pairs of planes: an object, and its coverage

struct MatteParams {
  ivec2 size;    // px
  uint objects;  // that are meant
};

struct NeededParams {
  ivec2 size;        // px of the image: its blocks
  ivec2 frame_size;  // px
  ivec2 offset;      // px from the frame's corner to that of the image's first block
  int reach;         // px of the image about a receiver whose estimates it needs
};

ALCOVE_END
#endif
