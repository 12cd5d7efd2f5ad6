// Parameters and bindings of prepare.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_PREPARE_H
#define ALCOVE_PREPARE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kPrepareRawDepth = 0;  // in: one float per pixel, as in the file; of positions three planes
// in: planes of floats, as many as normal_form needs; not read without normals
ALCOVE_CONSTANT uint kPrepareRawNormal = 1;
ALCOVE_CONSTANT uint kPrepareDepth = 2;  // out: one float per pixel, planar z > 0 in scene units, kSkyDepth on sky
// out: one uint per pixel, see normal.glsl: unit, view space, facing the eye; kNoNormal where there is none
ALCOVE_CONSTANT uint kPrepareNormal = 3;
ALCOVE_CONSTANT uint kPrepareCounts = 4;   // out: FrameCounts, zeroed before
ALCOVE_CONSTANT uint kPrepareMissing = 5;  // out: GroupCount of reconstruct: z becomes 1 where a normal is missing

ALCOVE_CONSTANT uint kDepthLinear = 0;  // z = base + slope * (raw - origin)
// z = 1 / (base + slope * (raw - origin)): 1/z, and the z-buffer of any perspective projection
ALCOVE_CONSTANT uint kDepthReciprocal = 1;
ALCOVE_CONSTANT uint kDepthExponential = 2;  // z = base * (exp(slope * (raw - origin)) - 1)
ALCOVE_CONSTANT uint kDepthPosition = 3;     // z = base + dot(axis, position); (0, 0, 0) is sky

ALCOVE_CONSTANT uint kNormalNone = 0;        // all are reconstructed from depth
ALCOVE_CONSTANT uint kNormalVector = 1;      // x, y, z of any length
ALCOVE_CONSTANT uint kNormalXy = 2;          // x, y of a unit vector with z >= 0
ALCOVE_CONSTANT uint kNormalOctahedral = 3;  // two coordinates in [-1, 1]
ALCOVE_CONSTANT uint kNormalSpheremap = 4;   // two coordinates in [-1, 1]

// The forms are specialization constants: a kernel with all of them takes twice as long on lavapipe, which computes
// both sides of a choice.
ALCOVE_CONSTANT uint kPrepareDepthFormId = 0;   // one of kDepth*
ALCOVE_CONSTANT uint kPrepareNormalFormId = 1;  // one of kNormal*

struct PrepareParams {
  View view;
  vec3 view_from_normal_x;  // rows of the rotation from the normals' space to view space
  vec3 view_from_normal_y;
  vec3 view_from_normal_z;
  vec3 depth_axis;            // scene units per unit of the file, of kDepthPosition
  uint along_ray;             // 0 or 1: what the form gives is the distance to the eye
  float origin, base, slope;  // see the forms; z in scene units
  float sky_below;            // raw depth at or below it is sky
  float sky_above;            // raw depth at or above it is sky
  float sky_depth;            // a distance at or beyond it is sky, scene units
  uint normal_unorm;          // 0 or 1: the file holds 0.5 + 0.5 n
};
ALCOVE_PARAMS(PrepareParams)

ALCOVE_END
#endif
