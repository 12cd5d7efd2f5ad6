// Tells how far the visibility of a pixel follows from what the frame shows, and is no guess.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, the visibilities with thin and with endless occluders, and with completed surfaces.
// Out: confidence.
//
// It is the product of four factors, each 1 where nothing is unknown:
// - The backs of what is seen are not seen, and neither is what goes on behind it or beyond the border. The truth lies
//   between the visibility with thin occluders, where nothing is completed, and that with endless ones, or with thin
//   ones and completed surfaces, whichever is less. The factor is 1 - their distance.
// - No estimate of what blocks is exact: 1 - half of what endless occluders block.
// - What is beyond the border is not seen. The factor is 1 less a fifth of the part that lies outside of the image, of
//   the disc in which the sphere of the radius is seen, times what endless occluders block: what is there blocks where
//   what is here does.
// - Depth is known to a precision. Below it no occluder can be told from noise, so the factor is 1 less a multiple of
//   the height that two depths' errors can feign, in radii.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/clearance.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ConfidenceParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, from prepare
readonly buffer Normal { uint normal[]; };  // one uint per pixel, from prepare
readonly buffer Thin { float thin[]; };     // one float per pixel, visibility where occluders are thin
readonly buffer Solid { float solid[]; };   // one float per pixel, visibility where they are endless
// one float per pixel, visibility where they are thin, and surfaces are completed as the settings say
readonly buffer Completed { float completed[]; };
writeonly buffer Result { float result[]; };  // one float per pixel, 0 to 1; 1 for sky

const int kDirections = 16;
const float kTwoPi = 6.28318530717958648;
// Both are fitted on rendered frames, so that the error falls as confidence rises.
const float kBlockedShare = 0.5;
const float kBorderShare = 0.2;

/// A radius of so many feigned heights is worth nothing.
const float kLeastRadius = 8.0;

/// The part of a disc of so many pixels about a pixel that lies outside of the image.
float part_outside(View view, ivec2 pixel, float pixels) {
  float within = 0.0;
  for (int k = 0; k < kDirections; k++) {
    const float angle = kTwoPi * (float(k) + 0.5) / float(kDirections);
    const vec2 direction = vec2(cos(angle), sin(angle));
    const float share = min(steps_to_border(view, pixel, direction) / max(pixels, 1e-6), 1.0);
    within += share * share;
  }
  return 1.0 - within / float(kDirections);
}

void main() {
  const View view = params.view;
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(view, pixel)) return;
  const int index = index_of(view, pixel);
  const float z = depth[index];
  if (z >= kSkyDepth) {
    result[index] = 1.0;
    return;
  }
  const bool perspective = view.orthographic == 0;
  const vec3 n = unpack_normal(normal[index]);
  const float least = min(solid[index], completed[index]);
  const float known_backs = 1.0 - clamp(thin[index] - least, 0.0, 1.0);
  const float blocked = 1.0 - clamp(solid[index], 0.0, 1.0);
  const float seen =
      1.0 - kBorderShare * blocked *
                part_outside(view, pixel, params.radius / (view.tangent_per_pixel.x * (perspective ? z : 1.0)));
  const vec2 tangent = perspective ? tangent_of(view, vec2(pixel) + 0.5) : vec2(0);
  const float fine =
      1.0 - min(kLeastRadius * least_height(params.depth_precision, z, dot(n.xy, tangent) - n.z) / params.radius, 1.0);
  result[index] = known_backs * (1.0 - kBlockedShare * blocked) * seen * fine;
}
