// Makes convexity, cavity and curvature of what the receiver's own surface leaves open inside and outside.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: for each radius two planes of what is open inside and outside; a matte.
// Out: of each that is wanted a plane; of several radii their mean, and a plane for each of them.
//
// All three are linear in both, and so is their mean. Sky, and where the matte is 0, shows a flat surface.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kMode = 0;  // bits of kCurvature*
layout(constant_id = 1) const int kRadii = 1;
layout(scalar, push_constant) uniform Push { CurvatureParams params; };
readonly buffer Open { float open[]; };    // planes of floats in [0, 1], 1 on sky; from `first` on two a radius
readonly buffer Matte { float matte[]; };  // one float per pixel, from matte; not read without
writeonly buffer Convexity { float convexity[]; };  // planes of floats in [0, 1]
writeonly buffer Cavity { float cavity[]; };        // the same
writeonly buffer Curvature { float curvature[]; };  // the same, 1/2 where all is flat

/// Writes what is blocked inside and outside.
void write(int index, vec2 blocked) {
  if ((kMode & kCurvatureConvexity) != 0u) convexity[index] = blocked.x;
  if ((kMode & kCurvatureCavity) != 0u) cavity[index] = blocked.y;
  if ((kMode & kCurvatureBoth) != 0u) curvature[index] = 0.5 + 0.5 * (blocked.x - blocked.y);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, params.size))) return;
  const int plane = params.size.x * params.size.y, index = pixel.y * params.size.x + pixel.x;
  const float part = (kMode & kCurvatureByMatte) != 0u ? matte[index] : 1.0;
  vec2 sum = vec2(0);
  for (int i = 0; i < kRadii; i++) {
    const int at = index + (int(params.first) + 2 * i) * plane;
    const vec2 blocked = part > 0.0 ? part * (1.0 - vec2(open[at], open[at + plane])) : vec2(0);
    write(index + (kRadii > 1 ? i + 1 : 0) * plane, blocked);
    sum += blocked;
  }
  if (kRadii > 1) write(index, sum / float(kRadii));
}
