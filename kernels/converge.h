// Parameters and bindings of converge.comp.
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
ALCOVE_CONSTANT uint kConvergeError = 4;  // out: one float per pixel, the estimated error of its tile
// out: one vec2 per tile, sum of the squared errors of its receivers, and their number
ALCOVE_CONSTANT uint kConvergeSquares = 5;
ALCOVE_CONSTANT uint kConvergeList = 6;        // in: one ListedTile per tile that had more directions
ALCOVE_CONSTANT uint kConvergeCounts = 7;      // in: TileCounts
ALCOVE_CONSTANT uint kConvergeNextList = 8;    // out: one ListedTile per tile that needs more still
ALCOVE_CONSTANT uint kConvergeNextCounts = 9;  // in and out: TileCounts, zeros
// in and out: GroupCount of profile, whose z is 0; it becomes 1 where any tile needs more
ALCOVE_CONSTANT uint kConvergeNextLines = 10;
ALCOVE_CONSTANT uint kConvergeNormal = 11;  // in: one uint per pixel, from prepare; only with kConvergeBentId
// in: planes x, y, z of the sums of what is blocked, from exact; out: where a tile needs no more directions, the mean
// open direction, as exact has it. Only with kConvergeBentId.
ALCOVE_CONSTANT uint kConvergeBent = 12;

ALCOVE_CONSTANT uint kConvergeBentId = 0;  // specialization: 1: bent normals too

struct ConvergeParams {
  View view;
  ivec2 origin;     // px: from the display window's corner to the image's; tiles count from the former
  float tolerance;  // RMS error of a tile's visibility
  uint directions;  // so far; 0: all tiles with surfaces are listed, and nothing else is read
  uint decides;     // 0: all tiles of the list stay, since there is no estimate to compare with
  uint ends;        // 1: no tile gets more
  uint plane;       // of the visibility
};
ALCOVE_PARAMS(ConvergeParams)

ALCOVE_END
#endif
