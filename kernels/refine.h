// Parameters and bindings of refine.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_REFINE_H
#define ALCOVE_REFINE_H
#include "converge.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kRefineDepth = 0;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kRefineJudged = 1;  // in: one JudgedTile per tile, from converge
ALCOVE_CONSTANT uint kRefineList = 2;    // in: one uint per tile that had more directions
ALCOVE_CONSTANT uint kRefineCounts = 3;  // in: TileCounts
// in and out: one float per pixel, the estimated error of its tile; of several radii the mean of theirs
ALCOVE_CONSTANT uint kRefineError = 4;
// out: one vec2 per tile, sum of the squared errors of its receivers, and their number
ALCOVE_CONSTANT uint kRefineSquares = 5;
ALCOVE_CONSTANT uint kRefineNextList = 6;    // out: one uint per tile that needs more still
ALCOVE_CONSTANT uint kRefineNextCounts = 7;  // in and out: TileCounts, zeros
// in and out: GroupCount of profile, whose z is 0; it becomes 1 where any tile needs more
ALCOVE_CONSTANT uint kRefineNextLines = 8;
ALCOVE_CONSTANT uint kRefineWhole =
    9;  // in: one float per pixel, sum of whole arcs, from exact; only with kRefineBentId
ALCOVE_CONSTANT uint kRefineNormal = 10;  // in: one uint per pixel, from prepare; only with kRefineBentId
// in: planes x, y, z of the sums of what is blocked, from exact; out: where a tile needs no more directions, the mean
// open direction, as exact has it. Only with kRefineBentId.
ALCOVE_CONSTANT uint kRefineBent = 11;

ALCOVE_CONSTANT uint kRefineBentId = 0;  // specialization: 1: bent normals too

// Comparisons that decide: after 4, 8, 16 and 32 directions. A tile that goes on at one of them can make its neighbours
// do so at the next.
ALCOVE_CONSTANT int kRefineRounds = 4;
// px from a pixel to those whose visibility decides how many directions it takes: its tile and one more a round
ALCOVE_CONSTANT int kRefineReach = kTile - 1 + kRefineRounds * kTile;

struct RefineParams {
  View view;
  ivec2 origin;     // px: from the display window's corner to the image's; tiles count from the former
  float tolerance;  // RMS error of a tile's visibility
  uint directions;  // so far; 0: all tiles with surfaces are listed, and there is no list to read
  uint decides;     // 0: all tiles of the list stay, since there is no estimate to compare with
  uint ends;        // 1: no tile gets more
  uint is_first;    // 1: this is the first of the radii
  float share;      // of a radius in the mean of all
};
ALCOVE_PARAMS(RefineParams)

ALCOVE_END
#endif
