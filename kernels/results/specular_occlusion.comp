// Tells how much of a glossy reflection is open: the part of the reflection's cone that lies within the cone of what
// the surface sees.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, bent normals, visibility.
// Out: specular occlusion, 1 = open.
//
// Jimenez et al., "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016: a cone about the bent normal b
// sees as much, cosine weighted, as the surface does: its half-angle is acos(sqrt(1 - ao)). The cone of a glossy lobe
// about the mirror direction r has the half-angle acos(2 ^ (-3.32193 roughness^2)), which holds most of what a rough
// mirror reflects. The result is what both cones share over what the lobe shares with the open hemisphere, so that an
// unoccluded surface has 1 at every view angle.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/shading.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/results/cones.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { SpecularOcclusionParams params; };
readonly buffer Depth { float depth[]; };     // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Normal { uint normal[]; };    // one uint per pixel, unit vector in view space, see normal.glsl
readonly buffer Bent { uint bent[]; };        // one uint per pixel, as the normal: the mean open direction
readonly buffer Ao { float ao[]; };           // one float per pixel, visibility in [0, 1]
writeonly buffer Result { float result[]; };  // one float per pixel in [0, 1]

/// Smoother surfaces count as this rough, a lobe of 6 degrees: areas of narrower cones are lost in rounding.
const float kLeastRoughness = 0.05;

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);
  const float z = depth[index], visibility = ao[index];
  if (z >= kSkyDepth) {
    result[index] = 1.0;
    return;
  }
  const vec3 eye = toward_eye(params.view, position_of(params.view, vec2(pixel) + 0.5, z));
  const vec3 n = unpack_normal(normal[index]), mirror = reflect(-eye, n);
  const float roughness = max(params.roughness, kLeastRoughness);
  const float cos_lobe = exp2(-3.32193 * roughness * roughness);
  const float seen =
      shared_solid_angle(sqrt(max(0.0, 1.0 - visibility)), cos_lobe, dot(unpack_normal(bent[index]), mirror));
  result[index] = min(1.0, seen / shared_solid_angle(0.0, cos_lobe, dot(n, mirror)));
}
