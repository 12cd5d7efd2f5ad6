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

// What is asked for is a specialization constant: lavapipe computes both sides of a choice, and powers are slow.
ALCOVE_CONSTANT uint kShapeModeId = 0;       // bits of those below
ALCOVE_CONSTANT uint kShapeByIntensity = 1;  // what is not asked for leaves every bit as it is
ALCOVE_CONSTANT uint kShapeByPower = 2;
ALCOVE_CONSTANT uint kShapeByFade = 4;
ALCOVE_CONSTANT uint kShapeByMaterial = 8;
ALCOVE_CONSTANT uint kShapeByMatte = 16;
ALCOVE_CONSTANT uint kShapeCountsRepaired = 32;  // else the frame's material AO has been counted

struct ShapeParams {
  ivec2 size;        // px
  float intensity;   // factor on the occlusion, >= 0
  float power;       // exponent of the visibility, > 0
  float fade_start;  // scene units of planar depth: where the AO begins to fade
  float fade_end;    // scene units, > fade_start: where it is 1
  float outside;     // visibility where the matte is 0
  uint planes;       // how many
};
ALCOVE_PARAMS(ShapeParams)

ALCOVE_END
#endif
