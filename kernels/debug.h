// Parameters and bindings of debug.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DEBUG_H
#define ALCOVE_DEBUG_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDebugDepth = 0;   // in: one float per pixel, planar depth, kSkyDepth for sky
ALCOVE_CONSTANT uint kDebugNormal = 1;  // in: one uint per pixel, unit vector in view space, see normal.glsl
// in: one float per pixel (kDebugValue) or a second set of normals (kDebugNormalAngle), or the kinds of tiles
// (kDebugTile), or what is hidden (kDebugHidden); not read by others
ALCOVE_CONSTANT uint kDebugValues = 2;
ALCOVE_CONSTANT uint kDebugResult = 3;  // out: one float per pixel
ALCOVE_CONSTANT uint kDebugRows = 4;    // in: 8 words per tile, see lattice.glsl; only if sparse

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
ALCOVE_PARAMS(DebugParams)

ALCOVE_END
#endif
