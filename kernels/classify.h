// Parameters and bindings of classify.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_CLASSIFY_H
#define ALCOVE_CLASSIFY_H
#include "ends.h"
#include "shared.h"
ALCOVE_BEGIN

// in: from bounds; only with kClassifyLayered and kClassifySkips
ALCOVE_CONSTANT uint kClassifyBounds = 0;
ALCOVE_CONSTANT uint kClassifyDepth = 1;   // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kClassifyNormal = 2;  // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kClassifyList = 3;    // out: one uint per tile, as many as are counted, in no order: see pack_tile
ALCOVE_CONSTANT uint kClassifyCounts = 4;  // in and out: TileCounts, zeros
// out: one float per pixel, 1 at receivers of tiles that are not listed; in the plane that the parameters name
ALCOVE_CONSTANT uint kClassifyAo = 5;
// out: planes x, y, z as estimators write them, for the same; only with kClassifyWithBent
ALCOVE_CONSTANT uint kClassifyBent = 6;
ALCOVE_CONSTANT uint kClassifyKinds = 7;  // out: one uint per tile: kTileOpen, kTileListed or kTileKept
// in: one uint per corner of blocks, (columns + 1) x (rows + 1): how many blocks above and left of it have changed
ALCOVE_CONSTANT uint kClassifyChanges = 8;
// out: one float per pixel, 0 at receivers of tiles that are not listed; only with kClassifyWithCompleted
ALCOVE_CONSTANT uint kClassifyCompleted = 9;
// in: one uint per tile, from needed: not 0 where estimates are needed; only with kClassifySelects
ALCOVE_CONSTANT uint kClassifyNeeded = 10;
ALCOVE_CONSTANT uint kClassifyRows = 11;  // in: 8 words per tile, see lattice.glsl; only if sparse

ALCOVE_CONSTANT uint kClassifySparseId = 0;  // specialization: 1: only sites have an estimate
ALCOVE_CONSTANT uint kClassifyModeId = 1;    // specialization: bits of kClassify*

ALCOVE_CONSTANT uint kClassifySkips = 1;  // else every tile is listed, and hidden surfaces count everywhere
ALCOVE_CONSTANT uint kClassifyWithBent = 2;
ALCOVE_CONSTANT uint kClassifyWithCompleted = 4;
// with kClassifySkips: reads the changes, and leaves tiles as they are within whose reach nothing has changed
ALCOVE_CONSTANT uint kClassifyReuses = 8;
ALCOVE_CONSTANT uint kClassifySelects = 16;  // with kClassifySkips: other tiles count as sky
ALCOVE_CONSTANT uint kClassifyLayered = 32;  // surfaces may be hidden: listed tiles say where these may count

// px of the frame beyond the reach: their depths may decide a normal that was reconstructed, or which surface a pixel
// of a smaller image shows; of hidden surfaces also which ends with the one before it, and closes its solid
ALCOVE_CONSTANT int kChangeMargin = 8;
ALCOVE_CONSTANT int kHiddenChangeMargin = kChangeMargin + kEndsReach + kEndsBeyond;

ALCOVE_CONSTANT int kChangeBlock = 32;  // px of the frame a side of the blocks whose changes are known

struct ClassifyParams {
  View view;
  float radius;      // scene units: the farthest at which anything blocks
  uint plane;        // of the AO
  ivec2 frame_size;  // px; the frame is the image, or `factor` times as large
  ivec2 overhang;    // px of the first pixel of the image that are outside of the frame
  int factor;
  int margin;  // px of the frame beyond the reach whose depths may decide what is within it
  // px of the image: from and up to where anybody needs estimates; with kClassifySkips tiles outside count as sky
  ivec2 needed_from, needed_to;
};
ALCOVE_PARAMS(ClassifyParams)

ALCOVE_END
#endif
