// Parameters and bindings of prepare.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_PREPARE_H
#define ALCOVE_PREPARE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kPrepareRawDepth = 0;   // in: float a pixel, as in the file
ALCOVE_CONSTANT uint kPrepareRawNormal = 1;  // in: three planes of floats, x, y, z; not read without normals
ALCOVE_CONSTANT uint kPrepareDepth = 2;      // out: float a pixel, planar z > 0 in scene units, kSkyDepth on sky
ALCOVE_CONSTANT uint kPrepareNormal = 3;     // out: uint a pixel, see normal.glsl: unit, view space, facing the eye
ALCOVE_CONSTANT uint kPrepareCounts = 4;     // out: FrameCounts, zeroed before

ALCOVE_CONSTANT uint kDepthPlanar = 0;   // distance along the optical axis
ALCOVE_CONSTANT uint kDepthRay = 1;      // distance to the eye
ALCOVE_CONSTANT uint kDepthInverse = 2;  // 1 / planar, 0 at infinity

struct PrepareParams {
  View view;
  vec3 view_from_normal_x;  // rows of the rotation from the normals' space to view space
  vec3 view_from_normal_y;
  vec3 view_from_normal_z;
  float depth_scale;        // scene units a unit of the file
  float sky_depth;          // a distance at or beyond it is sky, in the file's units
  uint depth_kind;          // one of kDepth*
  uint has_normals;         // 0: all are reconstructed from depth
};
ALCOVE_PARAMS(PrepareParams)

ALCOVE_END
#endif
