// Parameters and bindings of coarsen.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COARSEN_H
#define ALCOVE_COARSEN_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCoarsenTiles = 0;  // in: one TileBounds per tile, from bounds
// out: one GroupBounds per group of tiles, rows of groups from the upper left corner
ALCOVE_CONSTANT uint kCoarsenGroups = 1;

struct CoarsenParams {
  ivec2 size;  // px, of the image
};
ALCOVE_PARAMS(CoarsenParams)

ALCOVE_END
#endif
