// Parameters and bindings of accumulate.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_ACCUMULATE_H
#define ALCOVE_ACCUMULATE_H
#include "moved.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kAccumulateDepth = 0;   // in: one float per pixel of the part, planar depth
ALCOVE_CONSTANT uint kAccumulateNormal = 1;  // in: one uint per pixel of the part, see normal.glsl
ALCOVE_CONSTANT uint kAccumulateValues = 2;  // in: planes of floats in [0, 1] over all of the frame: its own estimate
ALCOVE_CONSTANT uint kAccumulateOthers = 3;  // in: planes of other frames, as words
ALCOVE_CONSTANT uint kAccumulateFrames = 4;  // in: their TakenFrame each
ALCOVE_CONSTANT uint kAccumulateNear = 5;    // in: words of cells, see moved.h
// in and out: planes of floats: how many estimates there are, and for each plane of values the sum of what they are
// less than 1; out where they begin
ALCOVE_CONSTANT uint kAccumulateSums = 6;
// out: the planes of values, as floats; only where the sums end
ALCOVE_CONSTANT uint kAccumulateAo = 7;      // the first one
ALCOVE_CONSTANT uint kAccumulateScales = 8;  // those of radii, which follow it
ALCOVE_CONSTANT uint kAccumulateBent = 9;    // those of the mean open direction, which are the last ones

ALCOVE_CONSTANT uint kAccumulatePlanesId = 0;  // specialization: of values
ALCOVE_CONSTANT uint kAccumulateListedId = 1;  // specialization: frames that the buffer lists, 0 to kMostTaken

ALCOVE_CONSTANT uint kAccumulateBegins = 1;  // the sums begin, with the frame's own estimate
ALCOVE_CONSTANT uint kAccumulateEnds = 2;    // the mean is made of them

struct AccumulateParams {
  View view;     // of all of the frame that takes the mean
  ivec2 size;    // px, of the part that is computed
  ivec2 corner;  // px from the frame's corner to that of the part
  float radius;  // scene units: what moves within it may change an estimate
  uint place;    // of the first frame of the buffer among all others
  int scales;    // of the values, those of radii
  uint frames;   // of these that count: the first ones
  uint stage;    // bits of kAccumulateBegins and kAccumulateEnds
};
ALCOVE_PARAMS(AccumulateParams)

ALCOVE_END
#endif
