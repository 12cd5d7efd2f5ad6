// Puts a margin around the frame, in which stands what other views see there.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth and normals of the frame; the nearest surfaces that other views show around it.
// Out: the same, of the frame with its margin. Normals of the margin are missing, for `reconstruct`.
//
// Where no other view shows anything, the surface of the nearest pixel of the frame goes on in its tangent plane: the
// border's completion begins at the margin's border then.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/geometry/geometry.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kStage = kWidenEmpty;  // one of kWiden* below
layout(scalar, push_constant) uniform Push { WidenParams params; };
readonly buffer Depth { float depth[]; };             // one float per pixel of `view`, planar depth
readonly buffer Normal { uint normal[]; };            // one uint per pixel of `view`, see normal.glsl
readonly buffer Found { uint found[]; };              // one key per pixel of `wide`, from the first round of `warp`
buffer WideDepth { float wide_depth[]; };             // one float per pixel of `wide`
writeonly buffer WideNormal { uint wide_normal[]; };  // one uint per pixel of `wide`

/// The depth at an image point of the plane of the frame's pixel.
float continued(ivec2 pixel, ivec2 nearest) {
  const int index = index_of(params.view, nearest);
  const float z = depth[index];
  if (z >= kSkyDepth || normal[index] == kNoNormal) return z;
  const ivec2 mirrored = clamp(2 * nearest - pixel, ivec2(0), params.view.size - 1);
  return depth_beyond(params.view, tangent_of(params.view, vec2(nearest) + 0.5), z, unpack_normal(normal[index]),
                      tangent_of(params.view, vec2(mirrored) + 0.5), depth[index_of(params.view, mirrored)],
                      tangent_of(params.view, vec2(pixel) + 0.5), 0.0);
}

void main() {
  const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.wide, place)) return;
  const ivec2 pixel = place - params.margin;
  const int index = index_of(params.wide, place);
  const bool is_margin = !inside(params.view, pixel);
  const ivec2 nearest = clamp(pixel, ivec2(0), params.view.size - 1);
  if (kStage == kWidenEmpty) {
    wide_depth[index] = is_margin ? 0.0 : depth[index_of(params.view, nearest)];
    wide_normal[index] = is_margin ? kNoNormal : normal[index_of(params.view, nearest)];
  } else if (is_margin) {
    wide_depth[index] = found[index] == 0u ? continued(pixel, nearest) : depth_of(found[index]);
  }
}
