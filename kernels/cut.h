// Parameters and bindings of cut.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_CUT_H
#define ALCOVE_CUT_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCutWide = 0;    // in: planes of words of the frame with its margin
ALCOVE_CONSTANT uint kCutResult = 1;  // out: planes of words of the frame

struct CutParams {
  ivec2 size;    // px, of the frame
  ivec2 wide;    // px, of the frame with its margin
  ivec2 margin;  // px to the left of the frame and above it
  uint planes;
};
ALCOVE_PARAMS(CutParams)

ALCOVE_END
#endif
