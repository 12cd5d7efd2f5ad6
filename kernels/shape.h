// Parameters and bindings of shape.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SHAPE_H
#define ALCOVE_SHAPE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kShapeAo = 0;      // in: float a pixel, visibility in [0, 1]
ALCOVE_CONSTANT uint kShapeShaped = 1;  // out: float a pixel, visibility in [0, 1]

struct ShapeParams {
  ivec2 size;       // px
  float intensity;  // factor on the occlusion, >= 0
  float power;      // exponent of the visibility, > 0
};
ALCOVE_PARAMS(ShapeParams)

ALCOVE_END
#endif
