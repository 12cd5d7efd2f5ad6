// Parameters of the kernel that core/chain/results/debug.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DEBUG_H
#define ALCOVE_DEBUG_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDebugValue = 0;        // the values as they are
ALCOVE_CONSTANT uint kDebugPlanarDepth = 1;  // scene units
ALCOVE_CONSTANT uint kDebugViewZ = 2;        // z in view space, scene units, below 0
ALCOVE_CONSTANT uint kDebugNormalZ = 3;      // z of the normal in view space
ALCOVE_CONSTANT uint kDebugNormalAngle = 4;  // degrees between the two sets of normals
ALCOVE_CONSTANT uint kDebugEdge = 5;         // distance of a neighbour from the tangent plane, part of the depth
ALCOVE_CONSTANT uint kDebugDensity = 7;      // share of the pixels of a square of 4 x 4 that are sites
ALCOVE_CONSTANT uint kDebugTile = 6;         // share of the directions that are searched, of the pixel's tile

ALCOVE_CONSTANT uint kDebugHidden = 8;  // surfaces behind the first, and half a one where any closes a solid

struct DebugParams {
  View view;
  uint kind;     // one of kDebug*
  uint sparse;   // of kDebugValue and kDebugDensity: 1: only sites have a value
  ivec2 origin;  // px from the display window's corner to the image's
  uint hidden;   // of kDebugHidden: planes of surfaces behind the first
};

ALCOVE_END
#endif
