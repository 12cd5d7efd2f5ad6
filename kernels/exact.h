// Parameters and bindings of exact.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_EXACT_H
#define ALCOVE_EXACT_H
#include "profile.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kExactDepth = 0;     // in: one float per pixel, from prepare
ALCOVE_CONSTANT uint kExactNormal = 1;    // in: one uint per pixel, from prepare
ALCOVE_CONSTANT uint kExactVertex = 2;    // in: from profile
ALCOVE_CONSTANT uint kExactMark = 3;      // in: from profile
ALCOVE_CONSTANT uint kExactNeighbor = 4;  // in: from profile
ALCOVE_CONSTANT uint kExactWhole = 5;     // in and out: one float per pixel, sum of whole arcs
// in and out: one float per pixel, sum of blocked arcs; after the last slice visibility in [0, 1], 1 = open
ALCOVE_CONSTANT uint kExactAo = 6;
ALCOVE_CONSTANT uint kExactList = 7;     // in: one uint per tile, from converge; only with kExactListedId
ALCOVE_CONSTANT uint kExactCounts = 8;   // in: TileCounts; only with kExactListedId
ALCOVE_CONSTANT uint kExactGoesOn = 9;   // in: from complete; only with kExactCompletesId
ALCOVE_CONSTANT uint kExactBehind = 10;  // the same
// in and out: one float per pixel, visibility that completed surfaces took; only where kExactCompletesId is 2
ALCOVE_CONSTANT uint kExactCompleted = 11;
// in and out: planes x, y, z of the sum of the bent_to() of what is blocked, in view space; after the last slice the
// mean open direction b as 0.5 + 0.5 b. Only with kExactBentId.
ALCOVE_CONSTANT uint kExactBent = 12;
ALCOVE_CONSTANT uint kExactOwn = 13;  // in: from profile; only with kExactSlotsId

// specialization: 1: the pixels of listed tiles take the slice, and no sum is ever completed; see stride, first,
// is_last
ALCOVE_CONSTANT uint kExactListedId = 0;
// specialization: 1: surfaces go on as complete has found; 2: and what they block is told apart
ALCOVE_CONSTANT uint kExactCompletesId = 1;
ALCOVE_CONSTANT uint kExactBentId = 2;   // specialization: 1: bent normals too
ALCOVE_CONSTANT uint kExactSlotsId = 3;  // specialization: of the profile, 1 to 1 + kMostHidden of layers.h
// specialization: 1: behind the slots' planes is one of the first surfaces, which go on unseen where no slot goes on
ALCOVE_CONSTANT uint kExactUnseenId = 4;

struct ExactParams {
  View view;
  Lines lines;  // as the profile's
  // px: from one pixel that takes this slice to the next, along and across: 1, or 2 where those of a block of 2 x 2
  // take others
  int stride;
  ivec2 first;             // px, along and across: the first pixel that takes it
  uint direction;          // which one it is
  uint is_first, is_last;  // 0 or 1: of those that a pixel takes
  float radius;            // scene units
  float thickness;       // scene units, of what is not connected to the receiver; infinite allowed; 0: as deep as wide
  uint plane;            // of the output, which has one plane per radius
  vec3 depth_precision;  // of planar depth: see clearance.glsl
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
};
ALCOVE_PARAMS(ExactParams)

ALCOVE_END
#endif
