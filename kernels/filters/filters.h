// Parameters of the kernels that core/chain/filters/filters.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_FILTERS_H
#define ALCOVE_FILTERS_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct CombineParams {
  ivec2 size;  // px
  uint count;  // planes
};

ALCOVE_CONSTANT int kDenoiseRun = 12;  // px along the axis that one invocation computes

struct DenoiseParams {
  View view;
  ivec2 axis;         // (1, 0): along rows; (0, 1): along columns
  float depth_sigma;  // of the depth: a step by this part of it weighs 1/e
  float weight[9];    // by the distance in pixels, 0 to the radius; of any sum
};

// A pixel takes the sites of the blocks beside its own, and each of these those of the two blocks beyond: 1 + 3 * 4 px.
ALCOVE_CONSTANT int kBlocksReach = 13;

struct FitBlocksParams {
  View view;
  SiteGrid grid;
  float reach;  // px at unit depth (orthographic: at any): from so far a site takes others
  float most;   // px: the most of that
  float held;   // px^2: the slopes of the plane are held back by as much spread of the sites
  int first;    // the first of the planes that are smoothed
};

struct SpreadBlocksParams {
  View view;
  SiteGrid grid;
  float slope;  // the part of the slopes at sites by which the values of pixels differ from theirs
};

ALCOVE_CONSTANT uint kInterpolateColumns = 1;  // columns, after rows; else rows
ALCOVE_CONSTANT uint kInterpolateByDepth = 2;  // weighs by depth_sigma instead of by planes and normals
ALCOVE_CONSTANT uint kInterpolateLooksUp = 4;  // weighs by `weight` instead of by the parabola

// Sites in reach weigh at least this part of what they weigh at the pixel itself: they may be all that there is.
ALCOVE_NUMBER kLeastWindow = 1e-6;

struct InterpolateParams {
  View view;
  SiteGrid grid;      // of the sites
  ivec2 axis;         // (1, 0): along rows; (0, 1): along columns
  float depth_sigma;  // of the depth: a step by this part of it weighs 1/e
  float reach;        // px, of the parabola at unit depth (orthographic: at any): from so far a site counts, in the
                      // limits of the kernel
  float most;         // px: the user's radius, from which a site counts at most
  float weight[9];    // by the distance in pixels, 0 to the radius; from the radius to the radius their sum is 1
};

struct UpsampleParams {
  View view;       // of the pixels
  ivec2 low_size;  // blocks
  ivec2 overhang;  // px: how far the first block reaches beyond the left and upper border
};

ALCOVE_END
#endif
