// Parameters and bindings of reduce.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_REDUCE_H
#define ALCOVE_REDUCE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kReducePlanes = 0;   // in: planes of floats
ALCOVE_CONSTANT uint kReduceWeights = 1;  // in: of each row or column of pixels, from params.first of the block on
ALCOVE_CONSTANT uint kReduceResult = 2;   // out: the same planes, all pixels of a block having its value

struct ReduceParams {
  ivec2 size;    // px
  ivec2 offset;  // px of the upper left block that lie left of the planes and above them
  int factor;    // px of a block in x and in y
  int first;     // px from a block's corner to the first pixel that counts for it, at most 0
  int count;     // weights, of which those of the block's own pixels are not all 0
  uint planes;
};
ALCOVE_PARAMS(ReduceParams)

ALCOVE_END
#endif
