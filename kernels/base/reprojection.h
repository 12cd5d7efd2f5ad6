// From one view of the world to another: shared by the kernels that look at a surface from two of them.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_REPROJECTION_H
#define ALCOVE_REPROJECTION_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct Reprojection {
  View from;
  View to;
  vec3 row_x, row_y, row_z;  // view space of `from` -> view space of `to`: rows of the linear part
  vec3 offset;               // and what is added, scene units
  // scene units: depths z of both views together may be off by x + y z + z z^2
  vec3 depth_precision;
  float separation;  // scene units: surfaces closer than it are one; below 0: by precision and a pixel's slope
};

// What a plane of flags says of a view's pixel.
ALCOVE_CONSTANT uint kFlagConfirmed = 1;    // another view sees its surface where it would be if it stood still
ALCOVE_CONSTANT uint kFlagSeenThrough = 2;  // another view sees what would be behind it
// Why a pixel's surface counts in no other view; 0: it counts.
ALCOVE_CONSTANT uint kFlagMoves = 4;        // it, or one beside it, is seen through
ALCOVE_CONSTANT uint kFlagUnconfirmed = 8;  // no other view has seen it
ALCOVE_CONSTANT uint kFlagUnfit = 16;       // it is sky, at a grazing angle, alone, or its depth is too coarse

ALCOVE_END
#endif
