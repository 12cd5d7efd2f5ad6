// Splits the surfaces behind the first into planes that other programs understand.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, below 0 of a surface that closes the solid before it.
// Out: for each surface planar depth > 0, kSkyDepth where there is none; and 1 where it closes a solid, else 0.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { HiddenPlanesParams params; };
readonly buffer Hidden { float hidden[]; };   // planes of floats, see GBuffer::hidden; not read where there are none
writeonly buffer Planes { float planes[]; };  // for each surface a plane of depth and one that says what it is

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel), plane = params.view.size.x * params.view.size.y;
  for (uint k = 0u; k < params.kept; k++) {
    const float z = k < params.known ? hidden[index + int(k) * plane] : kSkyDepth;
    planes[index + int(2u * k) * plane] = abs(z);
    planes[index + int(2u * k + 1u) * plane] = z < 0.0 ? 1.0 : 0.0;
  }
}
