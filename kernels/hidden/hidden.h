// Parameters of the kernels that core/chain/hidden/hidden.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HIDDEN_H
#define ALCOVE_HIDDEN_H
#include "kernels/base/reprojection.h"
#include "kernels/geometry/geometry.h"
ALCOVE_BEGIN

// What a plane holds: depth of surfaces, seen from inside or not; how far the first surface's solid goes on, as depth.
ALCOVE_CONSTANT uint kBehindSurfaces = 0;
ALCOVE_CONSTANT uint kBehindBacks = 1;
ALCOVE_CONSTANT uint kBehindThickness = 2;

struct BehindParams {
  View view;
  DepthTerms depth;
  uint plane;  // of both
};

ALCOVE_CONSTANT uint kMostHidden = 3;

struct LayersParams {
  View view;
  uint planes;           // that were found
  uint open_planes;      // bit i: surfaces of plane i are of unknown kind
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
  float separation;      // scene units: surfaces closer than it are one; below 0: by precision and a pixel's slope
};

/// Counts over a frame.
struct LayerCounts {
  uint surfaces;  // kept behind the first
  uint dropped;   // behind those that are kept
  uint before;    // that lie before the first surface, by more than the separation: nothing can be hidden there
};

ALCOVE_CONSTANT uint kEndsGroup = 32;  // lines of a workgroup

/// The ends of a surface count that are no more pixels away along its row and column. So much and kEndsBeyond more of a
/// picture around a crop make the crop the same as the whole.
ALCOVE_CONSTANT int kEndsReach = 64;
ALCOVE_CONSTANT int kEndsBeyond = 1;

struct EndsParams {
  View view;
  uint along_columns;  // 0 or 1
};

struct PairParams {
  View view;
};

struct HiddenPlanesParams {
  View view;
  uint known;  // planes that there are
  uint kept;   // surfaces to write
};

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

/// Counts over all other views of a frame.
struct ViewCounts {
  uint moved;        // left out: they move, or lie before what the frame shows
  uint unconfirmed;  // left out: no other view has seen them
};

ALCOVE_END
#endif
