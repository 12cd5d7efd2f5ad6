// Parameters and bindings of suspects.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SUSPECTS_H
#define ALCOVE_SUSPECTS_H
#include "moved.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kSuspectsOwn = 0;     // in: one float per pixel of the frame: depth as of a TakenFrame
ALCOVE_CONSTANT uint kSuspectsNormal = 1;  // in: one uint per pixel of the frame, see normal.glsl
ALCOVE_CONSTANT uint kSuspectsOthers = 2;  // in: planes of other frames, as words
ALCOVE_CONSTANT uint kSuspectsFrames = 3;  // in: their TakenFrame each
// out: a word per square: bit i: the i-th frame may see past what the frame itself has there; bit kMostTaken + i: the
// frame may see past what that one has in its own picture there
ALCOVE_CONSTANT uint kSuspectsBits = 4;

ALCOVE_CONSTANT uint kSuspectsListedId = 0;  // specialization: frames that the buffer lists, 1 to kMostTaken

struct SuspectsParams {
  View view;      // of the frame that takes the mean
  ivec2 squares;  // of the largest of all frames
};
ALCOVE_PARAMS(SuspectsParams)

ALCOVE_END
#endif
