// Parameters and bindings of directions.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DIRECTIONS_H
#define ALCOVE_DIRECTIONS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDirectionsDepth = 0;   // in: one float per pixel, planar depth, kSkyDepth for sky
ALCOVE_CONSTANT uint kDirectionsPacked = 1;  // in: one uint per pixel, unit vector in view space, see normal.glsl
ALCOVE_CONSTANT uint kDirectionsPlanes = 2;  // out: planes x, y, z

struct DirectionsParams {
  ivec2 size;        // px
  vec3 x_from_view;  // rows of the rotation from view space
  vec3 y_from_view;
  vec3 z_from_view;
};
ALCOVE_PARAMS(DirectionsParams)

ALCOVE_END
#endif
