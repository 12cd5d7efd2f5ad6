// Parameters and bindings of behind.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BEHIND_H
#define ALCOVE_BEHIND_H
#include "depth_terms.h"
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kBehindRaw = 0;    // in: planes of floats, as in the files
ALCOVE_CONSTANT uint kBehindDepth = 1;  // in: one float per pixel, planar depth of the first surface, from prepare
ALCOVE_CONSTANT uint kBehindFound = 2;  // out: planes of floats, see layers.h

ALCOVE_CONSTANT uint kBehindFormId = 0;  // specialization: one of kDepth*
ALCOVE_CONSTANT uint kBehindKindId = 1;  // specialization: one of kBehind* below

// What a plane holds: depth of surfaces, seen from inside or not; how far the first surface's solid goes on, as depth.
ALCOVE_CONSTANT uint kBehindSurfaces = 0;
ALCOVE_CONSTANT uint kBehindBacks = 1;
ALCOVE_CONSTANT uint kBehindThickness = 2;

struct BehindParams {
  View view;
  DepthTerms depth;
  uint plane;  // of both
};
ALCOVE_PARAMS(BehindParams)

ALCOVE_END
#endif
