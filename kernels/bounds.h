// Parameters and bindings of bounds.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BOUNDS_H
#define ALCOVE_BOUNDS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kBoundsDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kBoundsNormal = 1;  // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kBoundsTiles = 2;   // out: one TileBounds per tile, rows of tiles from the upper left corner
ALCOVE_CONSTANT uint kBoundsHidden = 3;  // in: planes of hidden surfaces, see GBuffer; none if there are none

struct BoundsParams {
  View view;
  uint hidden;  // planes of it
};
ALCOVE_PARAMS(BoundsParams)

ALCOVE_END
#endif
