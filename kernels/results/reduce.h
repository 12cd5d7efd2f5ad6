// Parameters of the kernel that core/chain/results/reduce.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_REDUCE_H
#define ALCOVE_REDUCE_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct ReduceParams {
  ivec2 size;    // px
  ivec2 offset;  // px of the upper left block that lie left of the planes and above them
  int factor;    // px of a block in x and in y
  int first;     // px from a block's corner to the first pixel that counts for it, at most 0
  int count;     // weights, of which those of the block's own pixels are not all 0
  uint planes;
};

ALCOVE_END
#endif
