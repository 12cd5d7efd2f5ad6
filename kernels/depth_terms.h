// How raw depth becomes planar depth: shared by the kernels that read it.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_DEPTH_TERMS_H
#define ALCOVE_DEPTH_TERMS_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kDepthLinear = 0;  // z = base + slope * (raw - origin)
// z = 1 / (base + slope * (raw - origin)): 1/z, and the z-buffer of any perspective projection
ALCOVE_CONSTANT uint kDepthReciprocal = 1;
ALCOVE_CONSTANT uint kDepthExponential = 2;  // z = base * (exp(slope * (raw - origin)) - 1)
ALCOVE_CONSTANT uint kDepthPosition = 3;     // z = base + dot(axis, position); (0, 0, 0) is sky

struct DepthTerms {
  vec3 axis;                  // scene units per unit of the file, of kDepthPosition
  uint along_ray;             // 0 or 1: what the form gives is the distance to the eye
  float origin, base, slope;  // see the forms; z in scene units
  float sky_below;            // raw depth at or below it is sky
  float sky_above;            // raw depth at or above it is sky
  float sky_depth;            // a distance at or beyond it is sky, scene units
};

ALCOVE_END
#endif
