// Parameters and bindings of pair.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_PAIR_H
#define ALCOVE_PAIR_H
#include "layers.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kPairDepth = 0;   // in: one float per pixel, planar depth of the first surface, from prepare
ALCOVE_CONSTANT uint kPairHidden = 1;  // in and out: planes of floats, from layers; see GBuffer::hidden
ALCOVE_CONSTANT uint kPairOpen = 2;    // in: one uint per pixel, from layers
ALCOVE_CONSTANT uint kPairEnds = 3;    // in: two planes of uints, from ends

ALCOVE_CONSTANT uint kPairKeptId = 0;  // specialization: planes of `hidden`, 1 to kMostHidden

struct PairParams {
  View view;
};
ALCOVE_PARAMS(PairParams)

ALCOVE_END
#endif
