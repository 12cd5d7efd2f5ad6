// Which pixels of a view can stand for their surface in another view.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, normals, and what other views say of them.
// Out: why a pixel cannot, or 0.
//
// What is seen through moves, and so may the pixels beside it. A pixel that has no neighbour in its tangent plane to
// the left or right, or none above or below, may hang in mid-air: files with smooth edges have such pixels.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/reprojection.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kConfirmed = 1;  // 0 or 1: what no other view confirms is not used
layout(scalar, push_constant) uniform Push { SurfelsParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, planar depth
readonly buffer Normal { uint normal[]; };  // one uint per pixel, see normal.glsl
readonly buffer Flags { uint flags[]; };    // one uint per pixel, from `still`
writeonly buffer Use { uint use[]; };       // one uint per pixel, 0 or one of kFlagMoves, kFlagUnconfirmed, kFlagUnfit

/// Surfaces that are turned away further are too uncertain, as the cosine to the eye.
const float kLeastCosine = 0.05;

bool has_alike(ivec2 pixel, ivec2 axis, vec3 position, vec3 n, float tolerance) {
  bool is_alike = false;
  for (int side = -1; side <= 1; side += 2) {
    const ivec2 at = pixel + side * axis;
    const float z = inside(params.view, at) ? depth[index_of(params.view, at)] : kSkyDepth;
    const float height = dot(n, position_of(params.view, vec2(at) + 0.5, finite_depth(z)) - position);
    is_alike = is_alike || z < kSkyDepth && abs(height) <= tolerance;
  }
  return is_alike;
}

bool is_fit(ivec2 pixel, float z, uint word) {
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z), n = unpack_normal(word);
  const float width = pixel_width(params.view, z), error = error_at(params.depth_precision, z);
  return word != kNoNormal && error <= width && dot(n, toward_eye(params.view, position)) >= kLeastCosine &&
         has_alike(pixel, ivec2(1, 0), position, n, width + error) &&
         has_alike(pixel, ivec2(0, 1), position, n, width + error);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);
  const float z = depth[index];
  const bool fits = z < kSkyDepth && is_fit(pixel, finite_depth(z), normal[index]);
  uint near = 0u;
  for (int y = -1; y <= 1; y++)
    for (int x = -1; x <= 1; x++)
      near |= flags[index_of(params.view, clamp(pixel + ivec2(x, y), ivec2(0), params.view.size - 1))];
  use[index] = !fits                                                      ? kFlagUnfit
               : (near & kFlagSeenThrough) != 0u                          ? kFlagMoves
               : kConfirmed != 0 && (flags[index] & kFlagConfirmed) == 0u ? kFlagUnconfirmed
                                                                          : 0u;
}
