// Parameters of the kernels that core/chain/hidden/warp.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_WARP_H
#define ALCOVE_WARP_H
#include "kernels/base/reprojection.h"
ALCOVE_BEGIN

struct StillParams {
  Reprojection by;
};

struct SurfelsParams {
  View view;
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

struct WarpParams {
  Reprojection by;
  uint round;  // the plane that is written: the nearest surfaces behind those of the plane before
};

/// What is counted over all other views of a frame.
struct ViewCounts {
  uint moved;        // left out: they move, or lie before what the frame shows
  uint unconfirmed;  // left out: no other view has seen them
};

ALCOVE_END
#endif
