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

ALCOVE_CONSTANT uint kDilateAlongColumns = 0;  // runs whose result may be other than 1 or than it was; before the rows
ALCOVE_CONSTANT uint kDilateAlongRows = 1;     // runs that those read
ALCOVE_CONSTANT uint kDilateUpsample = 2;      // workgroups of upsample

struct DilateParams {
  ivec2 size;          // px that the tiles are of
  int runs, lines;     // runs in a line, and lines of tiles; groups in x and y
  int runs_in_column;  // of what the columns are
  ivec2 full_size;     // px of what is upsampled, `factor` times as large
  ivec2 overhang;      // of these px, as upsample has it
  int factor;
};

ALCOVE_CONSTANT int kDenoiseMostRadius = 8;  // px
ALCOVE_CONSTANT int kDenoiseRun = 12;        // px along the axis that one invocation computes

struct DenoiseParams {
  View view;
  ivec2 axis;         // (1, 0): along rows; (0, 1): along columns
  float depth_sigma;  // of the depth: a step by this part of it weighs 1/e
  float weight[9];    // by the distance in pixels, 0 to the radius; of any sum
};

ALCOVE_CONSTANT int kLatticeStep = 4;  // px between the sites of the widest lattice
ALCOVE_CONSTANT int kSpreadReach = 4;  // px in x and in y from which a pixel takes the moments of sites
ALCOVE_CONSTANT int kFitReach = 12;    // px in x and in y from which a site takes others' estimates

ALCOVE_CONSTANT int kFitRun = 4;  // sites in a row that one invocation computes

struct FitSitesParams {
  View view;
  ivec2 first;  // px: the lattice's first pixel; it may lie beside the image
  ivec2 sites;  // in x and y
  float reach;  // px that the radius is wide at unit depth (orthographic: at any)
};

struct SpreadParams {
  View view;
  ivec2 first, sites;  // of the lattice, as FitSitesParams has them
};

ALCOVE_CONSTANT uint kInterpolateColumns = 1;  // columns, after rows; else rows
ALCOVE_CONSTANT uint kInterpolateListed = 2;   // only the runs of the list, not all
ALCOVE_CONSTANT uint kInterpolateByDepth = 4;  // weighs by depth_sigma instead of by planes and normals
ALCOVE_CONSTANT uint kInterpolateLooksUp = 8;  // weighs by `weight` instead of by the parabola
ALCOVE_CONSTANT uint kInterpolateFitted = 16;  // the sites of the lattice have the values of fit_sites

// Sites in reach weigh at least this part of what they weigh at the pixel itself: they may be all that there is.
ALCOVE_NUMBER kLeastWindow = 1e-6;

struct InterpolateParams {
  View view;
  ivec2 axis;          // (1, 0): along rows; (0, 1): along columns
  float depth_sigma;   // of the depth: a step by this part of it weighs 1/e
  float reach;         // px, of the parabola at unit depth (orthographic: at any): from so far a site counts, in the
                       // limits of the kernel
  float most;          // px: the user's radius, from which a site counts at most
  ivec2 first, sites;  // of the lattice, as FitSitesParams has them
  float weight[9];     // by the distance in pixels, 0 to the radius; from the radius to the radius their sum is 1
};

struct UpsampleParams {
  View view;       // of the pixels
  ivec2 low_size;  // blocks
  ivec2 overhang;  // px: how far the first block reaches beyond the left and upper border
};

ALCOVE_END
#endif
