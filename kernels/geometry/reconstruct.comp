// Makes normals from depth where the frame has none that is usable, and has those that face away face the eye.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth; normals, marked where they are missing.
// Out: those normals. The kernel runs where `prepare` has found any that are missing or face away.
//
// What is seen faces the eye. A normal that is the opposite of its surface's, by depth, is turned round: so are those
// of mirrored things and of the backs of cards. A shading normal that leans beyond the horizon is bent back to it.
//
// A pixel without a usable normal gets the normal of its own plane. 1/z is affine over a plane's image, so on each axis
// the side whose two neighbours predict this pixel's 1/z best is on the same plane, and its position difference is a
// tangent. Where both sides are on one surface, flat or curved, the difference over both is the better tangent: its
// error is of second order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { ReconstructParams params; };
readonly buffer Depth { float depth[]; };  // one float per pixel, from prepare
buffer Normal { uint normal[]; };          // one uint per pixel, see normal.glsl: all face the eye
buffer Counts { FrameCounts counts; };

/// The weight of a large change of 1/z against a side, beside its bend.
const float kNearness = 0.1;

/// Two sides are the same surface if their changes of 1/z differ by no more than so many errors of the better one, plus
/// kRounding of 1/z, and if both changes are less than this part of 1/z. Tuned on rendered scenes.
const float kSameSurface = 4.0;
const float kOneSurface = 0.01;

/// The value that an affine function over the image would have here, by the two neighbours on one side; orthographic
/// planes are affine in z, others in 1/z.
float affine_depth(ivec2 pixel) {
  if (!inside(params.view, pixel)) return -1.0;
  const float z = depth[index_of(params.view, pixel)];
  return z >= kSkyDepth ? -1.0 : params.view.orthographic != 0 ? z : 1.0 / z;
}

/// The change of position along one axis: on the side that predicts this pixel better, or over both where they are the
/// same surface. Zero where neither side has a surface.
vec3 tangent_along(ivec2 pixel, ivec2 axis, vec3 position, float here) {
  vec3 tangent = vec3(0), other = vec3(0);
  float least = 1e30;
  float step = 0.0;
  float other_step = 1e30;
  for (int side = -1; side <= 1; side += 2) {
    const float one = affine_depth(pixel + side * axis);
    const float two = affine_depth(pixel + 2 * side * axis);
    if (one <= 0.0) continue;
    const float change = float(side) * (one - here);
    const float bend = two > 0.0 ? abs(2.0 * one - two - here) : abs(change);
    const float error = bend + kNearness * abs(change);
    const float z = params.view.orthographic != 0 ? one : 1.0 / one;
    const vec3 along = float(side) * (position_of(params.view, vec2(pixel + side * axis) + 0.5, z) - position);
    if (error < least) {
      other = tangent;
      other_step = least < 1e30 ? step : 1e30;
      tangent = along;
      step = change;
      least = error;
    } else {
      other = along;
      other_step = change;
    }
  }
  const bool same = abs(step - other_step) <= kSameSurface * least + kRounding * here &&
                    max(abs(step), abs(other_step)) < kOneSurface * here;
  return same ? tangent + other : tangent;
}

vec3 normal_from_depth(ivec2 pixel, vec3 position, vec3 eye) {
  const float here = affine_depth(pixel);
  // Below are products of four lengths.
  const float per_unit = 1.0 / power_of_two(-position.z);
  const vec3 right = per_unit * tangent_along(pixel, ivec2(1, 0), position, here);
  const vec3 down = per_unit * tangent_along(pixel, ivec2(0, 1), position, here);
  // With one tangent only, the surface is taken to be as flat towards the eye as it allows; with none, to face the eye.
  vec3 n = cross(down, right);
  const vec3 only = right + down;
  if (dot(n, n) == 0.0 && dot(only, only) > 0.0) n = eye - only * (dot(eye, only) / dot(only, only));
  const float length_squared = dot(n, n);
  if (!is_finite(length_squared) || !(length_squared > 0.0)) return eye;
  const vec3 unit = n * inversesqrt(length_squared);
  return dot(unit, eye) < 0.0 ? -unit : unit;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);
  const uint word = normal[index];
  const float z = depth[index];
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z);
  const vec3 eye = toward_eye(params.view, position);
  vec3 n = unpack_normal(word);
  const bool is_missing = word == kNoNormal;
  if (z < kSkyDepth && (is_missing || dot(n, eye) < 0.0)) {
    const vec3 by_depth = normal_from_depth(pixel, position, eye);
    const bool is_turned = !is_missing && is_opposite(n, eye, by_depth);
    n = is_missing ? by_depth : is_turned ? -n : n;
    if (is_turned) atomicAdd(counts.turned_normals, 1u);
    normal[index] = pack_normal(facing(n, eye));
  }
}
