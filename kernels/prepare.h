// Parameters and bindings of prepare.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_PREPARE_H
#define ALCOVE_PREPARE_H
#include "depth_terms.h"
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kPrepareRawDepth = 0;  // in: one float per pixel, as in the file; of positions three planes
// in: planes of floats, as many as normal_form needs; not read without normals
ALCOVE_CONSTANT uint kPrepareRawNormal = 1;
ALCOVE_CONSTANT uint kPrepareDepth = 2;  // out: one float per pixel, planar z > 0 in scene units, kSkyDepth on sky
// out: one uint per pixel, see normal.glsl: unit, view space, facing the eye or clearly away; kNoNormal where there is
// none
ALCOVE_CONSTANT uint kPrepareNormal = 3;
ALCOVE_CONSTANT uint kPrepareCounts = 4;   // out: FrameCounts, zeroed before
ALCOVE_CONSTANT uint kPrepareMissing = 5;  // out: GroupCount of reconstruct: z becomes 1 where it has work

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
  DepthTerms depth;
  uint normal_unorm;  // 0 or 1: the file holds 0.5 + 0.5 n
};
ALCOVE_PARAMS(PrepareParams)

ALCOVE_END
#endif
