// Raw depth and normals -> the G-buffer that every later kernel relies on: z > 0 planar or marked sky;
// unit view-space normals that face the eye; nothing that is not finite. What was repaired is counted.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: raw depth of any kind or positions, raw normals of any encoding in world or view space. Out: planar z, view normals, counts.
// Spheremap: the equal-area map about -z (Mittring, "A bit more Deferred - CryEngine 3", 2009); octahedral: see normal.glsl.
// A pixel without a usable normal gets the normal of its own plane: 1/z is affine over a plane's image, so on each axis the
// side whose two neighbours predict this pixel's 1/z best is on the same plane, and its position difference is a tangent. Where
// both sides are on one surface, flat or curved, the difference over both is the better tangent: its error is of second order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "prepare.h"
#include "view.glsl"
#include "normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kPrepareDepthFormId) const uint kDepthForm = kDepthLinear;
layout(constant_id = kPrepareNormalFormId) const uint kNormalForm = kNormalVector;
layout(scalar, push_constant) uniform Push { PrepareParams params; };
layout(scalar, binding = kPrepareRawDepth) readonly buffer RawDepth { float raw_depth[]; };
layout(scalar, binding = kPrepareRawNormal) readonly buffer RawNormal { float raw_normal[]; };
layout(scalar, binding = kPrepareDepth) writeonly buffer Depth { float depth[]; };
layout(scalar, binding = kPrepareNormal) writeonly buffer Normal { uint normal[]; };
layout(scalar, binding = kPrepareCounts) buffer Counts { FrameCounts counts; };

/// Normals shorter than this are no direction at all (a background of zeros).
const float kLeastLength = 1e-6;

/// Reconstruction, all of 1/z: how much a large change counts against a side, beside its bend; the difference of the two sides' changes, in such errors and
/// in parts of 1/z (rounding), up to which they are the same surface; and the largest change of one surface. Tuned on rendered scenes.
const float kNearness = 0.1, kSameSurface = 4.0, kRounding = 1e-6, kOneSurface = 0.01;

bool finite(float x) { return !isnan(x) && !isinf(x); }

/// Planar depth in scene units, kSkyDepth where there is no surface.
float planar_depth(ivec2 pixel) {
  const int index = index_of(params.view, pixel);
  const float raw = raw_depth[index];
  float z;
  if (kDepthForm == kDepthPosition) {
    const int plane = params.view.size.x * params.view.size.y;
    const vec3 position = vec3(raw, raw_depth[index + plane], raw_depth[index + 2 * plane]);
    if (position == vec3(0)) return kSkyDepth;
    z = params.base + dot(params.depth_axis, position);
  } else {
    if (!(raw > params.sky_below && raw < params.sky_above)) return kSkyDepth;
    const float value = params.slope * (raw - params.origin);
    z = kDepthForm == kDepthReciprocal ? 1.0 / (params.base + value)
        : kDepthForm == kDepthExponential ? params.base * (exp(value) - 1.0) : params.base + value;
  }
  if (!(z > 0.0 && z < params.sky_depth)) return kSkyDepth;
  const vec2 t = tangent_of(params.view, vec2(pixel) + 0.5);
  if (params.along_ray != 0) z *= inversesqrt(1.0 + dot(t, t));
  return z < kSkyDepth ? z : kSkyDepth;
}

/// The file's normal as a vector, in its own space and of any length; zero where it is none.
vec3 decoded_normal(int index) {
  const int plane = params.view.size.x * params.view.size.y;
  vec3 raw = vec3(raw_normal[index], raw_normal[index + plane], 0);
  if (kNormalForm == kNormalVector) raw.z = raw_normal[index + 2 * plane];
  if (params.normal_unorm != 0) raw = 2.0 * raw - 1.0;
  const float squared = dot(raw.xy, raw.xy);
  switch (kNormalForm) {
    case kNormalXy: return vec3(raw.xy, sqrt(max(1.0 - squared, 0.0)));
    case kNormalOctahedral: return octahedral_direction(raw.xy);
    case kNormalSpheremap: return squared <= 1.0 ? vec3(2.0 * sqrt(1.0 - squared) * raw.xy, 2.0 * squared - 1.0) : vec3(0);
    default: return raw;
  }
}

/// What an affine function over the image would be here, going by the two neighbours on one side; orthographic planes are affine in z, others in 1/z.
float affine_depth(ivec2 pixel) {
  if (!inside(params.view, pixel)) return -1.0;
  const float z = planar_depth(pixel);
  return z >= kSkyDepth ? -1.0 : params.view.orthographic != 0 ? z : 1.0 / z;
}

/// The change of position along one axis: on the side that predicts this pixel better, or over both where they are the same surface. Zero where neither
/// side has a surface.
vec3 tangent_along(ivec2 pixel, ivec2 axis, vec3 position, float here) {
  vec3 tangent = vec3(0), other = vec3(0);
  float least = 1e30, step = 0.0, other_step = 1e30;
  for (int side = -1; side <= 1; side += 2) {
    const float one = affine_depth(pixel + side * axis), two = affine_depth(pixel + 2 * side * axis);
    if (one <= 0.0) continue;
    const float change = float(side) * (one - here), bend = two > 0.0 ? abs(2.0 * one - two - here) : abs(change);
    const float error = bend + kNearness * abs(change), z = params.view.orthographic != 0 ? one : 1.0 / one;
    const vec3 along = float(side) * (position_of(params.view, vec2(pixel + side * axis) + 0.5, z) - position);
    if (error < least) {
      other = tangent, other_step = least < 1e30 ? step : 1e30;
      tangent = along, step = change, least = error;
    } else {
      other = along, other_step = change;
    }
  }
  const bool same = abs(step - other_step) <= kSameSurface * least + kRounding * here && max(abs(step), abs(other_step)) < kOneSurface * here;
  return same ? tangent + other : tangent;
}

vec3 normal_from_depth(ivec2 pixel, vec3 position, vec3 eye) {
  const float here = affine_depth(pixel);
  const vec3 right = tangent_along(pixel, ivec2(1, 0), position, here), down = tangent_along(pixel, ivec2(0, 1), position, here);
  // With one tangent only, the surface is taken to be as flat towards the eye as it allows; with none, to face the eye.
  vec3 n = cross(down, right);
  const vec3 only = right + down;
  if (dot(n, n) == 0.0 && dot(only, only) > 0.0) n = eye - only * (dot(eye, only) / dot(only, only));
  const float length_squared = dot(n, n);
  if (!(length_squared > 0.0) || isinf(length_squared)) return eye;
  const vec3 unit = n * inversesqrt(length_squared);
  return dot(unit, eye) < 0.0 ? -unit : unit;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);

  const float z = planar_depth(pixel);
  depth[index] = z;
  if (z >= kSkyDepth) {
    normal[index] = pack_normal(vec3(0, 0, 1));
    atomicAdd(counts.sky, 1u);
    if (isnan(raw_depth[index]) || raw_depth[index] < params.sky_below) atomicAdd(counts.repaired_depth, 1u);
    return;
  }

  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z), eye = toward_eye(params.view, position);
  vec3 n = vec3(0);
  if (kNormalForm != kNormalNone) {
    const vec3 raw = decoded_normal(index);
    n = vec3(dot(params.view_from_normal_x, raw), dot(params.view_from_normal_y, raw), dot(params.view_from_normal_z, raw));
  }
  const float size = length(n);
  if (finite(size) && size > kLeastLength) {
    n /= size;
  } else {
    n = normal_from_depth(pixel, position, eye);
    if (kNormalForm != kNormalNone) atomicAdd(counts.repaired_normals, 1u);
  }
  normal[index] = pack_normal(facing(n, eye));
}
