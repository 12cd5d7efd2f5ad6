// Parameters and bindings of shape.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SHAPE_H
#define ALCOVE_SHAPE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kShapeAo = 0;      // in: planes of visibility in [0, 1]
ALCOVE_CONSTANT uint kShapeShaped = 1;  // out: as many planes, in [0, 1]
// in: one float per pixel, planar depth, kSkyDepth for sky; not read without fade and material
ALCOVE_CONSTANT uint kShapeDepth = 2;
ALCOVE_CONSTANT uint kShapeMaterial = 3;  // in: one float per pixel, visibility; not read without
ALCOVE_CONSTANT uint kShapeMatte = 5;     // in: one float per pixel, from matte; not read without
ALCOVE_CONSTANT uint kShapeCounts = 4;    // in and out: FrameCounts

struct ShapeParams {
  ivec2 size;            // px
  float intensity;       // factor on the occlusion, >= 0
  float power;           // exponent of the visibility, > 0
  float fade_start;      // scene units of planar depth: where the AO begins to fade
  float fade_end;        // scene units, > fade_start: where it is 1
  uint has_fade;         // 0 or 1
  uint has_material;     // 0 or 1
  uint has_matte;        // 0 or 1
  float outside;         // visibility where the matte is 0
  uint planes;           // how many
  uint counts_repaired;  // 0: the frame's material AO has been counted
};
ALCOVE_PARAMS(ShapeParams)

ALCOVE_END
#endif
