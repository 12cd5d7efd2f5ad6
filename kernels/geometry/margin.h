// Parameters of the kernels that core/chain/geometry/margin.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_MARGIN_H
#define ALCOVE_MARGIN_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kWidenEmpty = 0;   // the margin is left open: all that other views see is behind it
ALCOVE_CONSTANT uint kWidenFilled = 1;  // the margin alone is written, with what was found

struct WidenParams {
  View view;
  View wide;
  ivec2 margin;  // px that `wide` has to the left of `view` and above it
};

struct CutParams {
  ivec2 size;    // px, of the frame
  ivec2 wide;    // px, of the frame with its margin
  ivec2 margin;  // px to the left of the frame and above it
  uint planes;
};

ALCOVE_END
#endif
