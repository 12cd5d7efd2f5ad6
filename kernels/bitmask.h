// Specialization of bitmask.comp; its parameters and bindings are those of slices.h.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BITMASK_H
#define ALCOVE_BITMASK_H
#include "horizon.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kBitmaskSlicesId = 0;    // specialization: slices per pixel
ALCOVE_CONSTANT uint kBitmaskStepsId = 1;     // specialization: steps to each side of a slice
ALCOVE_CONSTANT uint kBitmaskModeId = 2;      // specialization: one of kFalloff* of falloff.glsl, and kWith* or not
ALCOVE_CONSTANT uint kBitmaskSparseId = 3;    // specialization: 1: only the sites of the list are estimated
ALCOVE_CONSTANT uint kBitmaskCompleteId = 4;  // specialization: bits of kCompletes* of horizon.h, and kHiddenSurface

ALCOVE_END
#endif
