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
#include "kernels/results/results.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { SpecularOcclusionParams params; };
readonly buffer Depth { float depth[]; };     // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Normal { uint normal[]; };    // one uint per pixel, unit vector in view space, see normal.glsl
readonly buffer Bent { uint bent[]; };        // one uint per pixel, as the normal: the mean open direction
readonly buffer Ao { float ao[]; };           // one float per pixel, visibility in [0, 1]
writeonly buffer Result { float result[]; };  // one float per pixel in [0, 1]

/// Smoother surfaces count as this rough, a lobe of 6 degrees: areas of narrower cones are lost in rounding.
const float kLeastRoughness = 0.05;

/// The angle of this cosine, in [0, pi].
float angle_of_cosine(float cosine) {
  const float c = clamp(cosine, -1.0, 1.0);
  return angle_of(c, sqrt((1.0 - c) * (1.0 + c)));
}

/// The solid angle that two cones with one apex share, by the cosines of their half-angles, which are at most a right
/// angle, and of the angle between their axes. It is exact: the area of the intersection of two spherical caps, the two
/// sectors less the two spherical triangles between centres and corners (Oat and Sander, "Ambient Aperture Lighting",
/// 2007, give the same area and then approximate it).
float shared_solid_angle(float cos_a, float cos_b, float cos_between) {
  const float a = angle_of_cosine(cos_a);
  const float b = angle_of_cosine(cos_b);
  const float between = angle_of_cosine(cos_between);
  if (between >= a + b) return 0.0;
  if (between <= abs(a - b)) return 2.0 * kPi * (1.0 - max(cos_a, cos_b));  // the narrower one lies in the wider
  const float sin_a = sqrt((1.0 - cos_a) * (1.0 + cos_a));
  const float sin_b = sqrt((1.0 - cos_b) * (1.0 + cos_b));
  const float sin_between = sqrt((1.0 - cos_between) * (1.0 + cos_between));
  const float corner = angle_of_cosine((cos_between - cos_a * cos_b) / (sin_a * sin_b));
  const float at_a = angle_of_cosine((cos_b - cos_between * cos_a) / (sin_between * sin_a));
  const float at_b = angle_of_cosine((cos_a - cos_between * cos_b) / (sin_between * sin_b));
  return max(0.0, 2.0 * (kPi - corner - at_a * cos_a - at_b * cos_b));
}

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
  const float open = shared_solid_angle(0.0, cos_lobe, dot(n, mirror));
  result[index] = seen < open ? seen / open : 1.0;  // where all is open exactly 1: a / a need not be
}
