// Makes a unit vector of the mean open direction; where nothing is open it is the normal.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: packed normals, planes of the moments of what is blocked.
// Out: packed unit vectors. What they are on sky has no meaning.
//
// Every open direction stands above the tangent plane, and so does their mean. Where noise has put it below, it is
// lifted onto the plane.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/normal.glsl"
#include "kernels/base/moments.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { BentNormalParams params; };
readonly buffer Normal { uint normal[]; };     // one uint per pixel, from prepare
readonly buffer Moments { float moments[]; };  // planes of moments of first order at least, see stored_moment()
writeonly buffer Result { uint result[]; };    // one uint per pixel, as the normal

/// Means as short as this are half the normal: a thousandth of what an open surface has.
const float kLeastLength = 2.0 / 3.0 * 1e-3;

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int plane = params.size.x * params.size.y, index = pixel.y * params.size.x + pixel.x;
  const vec3 n = unpack_normal(normal[index]);
  vec3 b = open_moments(n)[0];
  for (int k = 0; k < 3; k++) b[k] -= blocked_moment(moments[index + k * plane]);
  result[index] = pack_normal(normalize(b + (max(0.0, -dot(b, n)) + kLeastLength) * n));
}
