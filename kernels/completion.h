// Parameters and bindings of completion.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COMPLETION_H
#define ALCOVE_COMPLETION_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCompletionDepth = 0;      // in: one float per pixel, planar depth, kSkyDepth for sky
ALCOVE_CONSTANT uint kCompletionAo = 1;         // in: one float per pixel, visibility; the plane of the parameters
ALCOVE_CONSTANT uint kCompletionCompleted = 2;  // in: one float per pixel, visibility that completed surfaces took
// out: one vec2 per tile, sums over its receivers of the visibility that is taken by completed surfaces, and by all
ALCOVE_CONSTANT uint kCompletionSums = 3;

struct CompletionParams {
  View view;
  ivec2 origin;  // px from the display window's corner to the image's
  int spacing;   // of the widest lattice of sites: see lattice.glsl; 1: all pixels have an estimate
  uint plane;    // of the visibility
};
ALCOVE_PARAMS(CompletionParams)

ALCOVE_END
#endif
