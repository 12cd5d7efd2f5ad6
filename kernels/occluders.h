// Parameters and bindings of occluders.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_OCCLUDERS_H
#define ALCOVE_OCCLUDERS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kOccludersDepth = 0;     // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kOccludersMatte = 1;     // in: one float per pixel, from matte
ALCOVE_CONSTANT uint kOccludersHidden = 2;    // in: planes of hidden surfaces, see GBuffer; only where there are any
ALCOVE_CONSTANT uint kOccludersResult = 3;    // out: one float per pixel, the first surface's depth if it may block
ALCOVE_CONSTANT uint kOccludersBehind = 4;    // out: as the planes of hidden surfaces
ALCOVE_CONSTANT uint kOccludersNormal = 5;    // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kOccludersHiddenId = 0;  // specialization: planes of hidden surfaces, 0 to kMostHidden of layers.h

// px: pixels that objects share look so far for one that tells them apart
ALCOVE_CONSTANT int kOccludersReach = 2;

struct OccludersParams {
  View view;
  uint ignores;    // 1: what the matte takes is no occluder; 0: what it does not take
  uint keeps;      // 1: where nothing is known behind such a surface, it stays
  uint lists_all;  // 1: a pixel with fewer hidden surfaces has no more: see GBuffer::hides_no_more
};
ALCOVE_PARAMS(OccludersParams)

ALCOVE_END
#endif
