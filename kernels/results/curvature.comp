// Makes convexity, cavity or curvature of what the receiver's own surface leaves open inside and outside.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth (for the sky), for each radius two planes of what is open inside and outside, a matte.
// Out: a plane; of several radii their mean and a plane for each of them.
//
// Each is linear in both, and so is their mean. Sky, and where the matte is 0, shows a flat surface.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kHasMatte = 0u;
layout(scalar, push_constant) uniform Push { CurvatureParams params; };
readonly buffer Depth { float depth[]; };    // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Open { float open[]; };      // planes of floats in [0, 1], those of curvature from `first` on
readonly buffer Matte { float matte[]; };    // one float per pixel, from matte; not read without
writeonly buffer Result { float result[]; };  // planes of floats in [0, 1]

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int plane = params.size.x * params.size.y, index = pixel.y * params.size.x + pixel.x;
  const int radii = int(params.radii), own = radii > 1 ? 1 : 0;
  float part = depth[index] < kSkyDepth ? 1.0 : 0.0;
  if (kHasMatte != 0u) part *= matte[index];
  float sum = 0.0;
  for (int i = 0; i < radii; i++) {
    const int at = index + (int(params.first) + 2 * i) * plane;
    const float value = part > 0.0 ? part * (params.inside * (1.0 - open[at]) + params.outside * (1.0 - open[at + plane])) : 0.0;
    result[index + (i + own) * plane] = params.flat_value + value;
    sum += value;
  }
  if (own > 0) result[index] = params.flat_value + sum / float(radii);
}
