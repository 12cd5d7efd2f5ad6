// Parameters and bindings of ends.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_ENDS_H
#define ALCOVE_ENDS_H
#include "layers.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kEndsDepth = 0;   // in: one float per pixel, planar depth of the first surface, from prepare
ALCOVE_CONSTANT uint kEndsHidden = 1;  // in: planes of floats, from layers
ALCOVE_CONSTANT uint kEndsResult = 2;  // out: two planes of uints, along rows and along columns, see pack_ends

ALCOVE_CONSTANT uint kEndsKeptId = 0;  // specialization: planes of `hidden`, 1 to kMostHidden

ALCOVE_CONSTANT uint kEndsGroup = 32;  // lines of a workgroup

/// The ends of a surface count that are no more pixels away along its row and column. So much and kEndsBeyond more of a
/// picture around a crop make the crop the same as the whole.
ALCOVE_CONSTANT int kEndsReach = 64;
ALCOVE_CONSTANT int kEndsBeyond = 1;

struct EndsParams {
  View view;
  uint along_columns;  // 0 or 1
};
ALCOVE_PARAMS(EndsParams)

ALCOVE_END
#endif
