// Turns packed unit vectors in view space into planes x, y, z in the space that a file holds them in; sky has none: 0,
// 0, 0.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth (for the sky), packed vectors.
// Out: planes.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { DirectionsParams params; };
readonly buffer Depth { float depth[]; };             // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Packed { uint packed_direction[]; };  // one uint per pixel, unit vector in view space, see normal.glsl
writeonly buffer Planes { float planes[]; };          // planes x, y, z

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int plane = params.size.x * params.size.y, index = pixel.y * params.size.x + pixel.x;
  const vec3 d = depth[index] < kSkyDepth ? unpack_normal(packed_direction[index]) : vec3(0);
  planes[index] = dot(params.x_from_view, d);
  planes[index + plane] = dot(params.y_from_view, d);
  planes[index + 2 * plane] = dot(params.z_from_view, d);
}
