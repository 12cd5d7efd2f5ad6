// Parameters and bindings of converge.comp, and what it says of tiles.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_CONVERGE_H
#define ALCOVE_CONVERGE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kConvergeDepth = 0;    // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kConvergeBlocked = 1;  // in: one float per pixel, sum of blocked arcs, from exact
ALCOVE_CONSTANT uint kConvergeWhole = 2;    // in: one float per pixel, sum of whole arcs, from exact
// in and out: one float per pixel, visibility by half of the directions, then by all; the plane of the parameters
ALCOVE_CONSTANT uint kConvergeAo = 3;
ALCOVE_CONSTANT uint kConvergeJudged = 4;  // out: one JudgedTile per tile
ALCOVE_CONSTANT uint kConvergeList = 5;    // in: one uint per tile that had more directions, from refine
ALCOVE_CONSTANT uint kConvergeCounts = 6;  // in: TileCounts, from refine

/// How well a tile is known.
struct JudgedTile {
  float squares;    // sum of the squared errors of its receivers, as one comparison estimates them
  float receivers;  // pixels that are not sky
  uint directions;  // that it had then; 0: none yet
};

struct ConvergeParams {
  View view;
  ivec2 origin;     // px: from the display window's corner to the image's; tiles count from the former
  uint directions;  // so far; 0: all tiles begin, and there is no list to read
  uint plane;       // of the visibility
};
ALCOVE_PARAMS(ConvergeParams)

ALCOVE_END
#endif
