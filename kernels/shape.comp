// Artistic shaping of the visibility: max(0, 1 - intensity (1 - ao)) ^ power. 1 stays 1.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: visibility. Out: visibility.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shape.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ShapeParams params; };
layout(scalar, binding = kShapeAo) readonly buffer Ao { float ao[]; };
layout(scalar, binding = kShapeShaped) writeonly buffer Shaped { float shaped[]; };

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int index = pixel.y * params.size.x + pixel.x;
  const float base = clamp(1.0 - params.intensity * (1.0 - ao[index]), 0.0, 1.0);
  shaped[index] = base > 0.0 ? pow(base, params.power) : 0.0;
}
