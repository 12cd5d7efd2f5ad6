// Parameters and bindings of interpolate.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_INTERPOLATE_H
#define ALCOVE_INTERPOLATE_H
#include "denoise.h"
ALCOVE_BEGIN

// in: planes of floats in [0, 1], visibility or the like, at sites; of columns: what rows have made, see pack_blocked
ALCOVE_CONSTANT uint kInterpolateAo = 0;
ALCOVE_CONSTANT uint kInterpolateDepth = 1;   // in: one float per pixel, of the G-buffer of that visibility
ALCOVE_CONSTANT uint kInterpolateNormal = 2;  // in: one uint per pixel, of the same; not read with a depth sigma
ALCOVE_CONSTANT uint kInterpolateResult = 3;  // out: as many planes of all pixels, in [0, 1]; of rows: see pack_blocked
ALCOVE_CONSTANT uint kInterpolateList = 4;    // in: one uint per run, from dilate; only if listed
ALCOVE_CONSTANT uint kInterpolateCounts = 5;  // in: RunCounts of it
// rows: in and out, zeros; columns: in: a word for each run of a row and 32 rows, with a bit for each that is written
ALCOVE_CONSTANT uint kInterpolateRuns = 7;
ALCOVE_CONSTANT uint kInterpolateSites = 6;  // in: 8 words per tile, see lattice.glsl; not read along columns

ALCOVE_CONSTANT uint kInterpolateRadiusId = 0;  // specialization: pixels to each side, 1 to kDenoiseMostRadius
ALCOVE_CONSTANT uint kInterpolateModeId = 1;    // specialization: bits of these
ALCOVE_CONSTANT uint kInterpolatePlanesId = 2;  // specialization: how many planes; they share their weights

ALCOVE_CONSTANT uint kInterpolateColumns = 1;  // columns, after rows; else rows
ALCOVE_CONSTANT uint kInterpolateListed = 2;   // only the runs of the list, not all
ALCOVE_CONSTANT uint kInterpolateByDepth = 4;  // weighs by depth_sigma instead of by plane distance
ALCOVE_CONSTANT uint kInterpolateLooksUp = 8;  // weighs by `weight` instead of by the parabola

// Sites in reach weigh at least this part of what they weigh at the pixel itself: they may be all that there is.
ALCOVE_NUMBER kLeastWindow = 1e-6;

struct InterpolateParams {
  View view;
  ivec2 axis;         // (1, 0): along rows; (0, 1): along columns
  float depth_sigma;  // of the depth: a step by this part of it weighs 1/e
  float missing;      // what a pixel gets that no site is in reach of: 1, or the middle of what a plane holds
  float narrowness;   // of a parabola: at d pixels 1 - d^2 times this of what it is at 0; at least kLeastWindow
  float weight[9];    // by the distance in pixels, 0 to the radius; from the radius to the radius their sum is 1
};
ALCOVE_PARAMS(InterpolateParams)

ALCOVE_END
#endif
