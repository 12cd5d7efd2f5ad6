// Parameters and bindings of warp.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_WARP_H
#define ALCOVE_WARP_H
#include "reprojection.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kWarpDepth = 0;   // in: one float per pixel of `from`, planar depth
ALCOVE_CONSTANT uint kWarpNormal = 1;  // in: one uint per pixel of `from`, see normal.glsl
ALCOVE_CONSTANT uint kWarpUse = 2;     // in: one uint per pixel of `from`, 0 where it is used, see surfels.h
ALCOVE_CONSTANT uint kWarpFirst = 3;   // in: one float per pixel of `to`, planar depth of the first surface
// in and out: planes of keys of `to`, zeroed before: see key_of() of keys.glsl
ALCOVE_CONSTANT uint kWarpFound = 4;
ALCOVE_CONSTANT uint kWarpCounts = 5;  // in and out: ViewCounts, zeroed before

struct WarpParams {
  Reprojection by;
  uint round;  // the plane that is written: the nearest surfaces behind those of the plane before
};
ALCOVE_PARAMS(WarpParams)

/// What is counted over all other views of a frame.
struct ViewCounts {
  uint moved;        // left out: they move, or lie before what the frame shows
  uint unconfirmed;  // left out: no other view has seen them
};

ALCOVE_END
#endif
