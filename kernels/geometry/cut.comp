// Cuts the margin off that `widen` has put around the frame.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planes of words of the frame with its margin.
// Out: those of the frame.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CutParams params; };
readonly buffer Wide { uint wide[]; };       // planes of words of the frame with its margin
writeonly buffer Result { uint result[]; };  // planes of words of the frame

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const ivec2 place = pixel + params.margin;
  for (int i = 0; i < int(params.planes); i++)
    result[(i * params.size.y + pixel.y) * params.size.x + pixel.x] =
        wide[(i * params.wide.y + place.y) * params.wide.x + place.x];
}
