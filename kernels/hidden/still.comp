// Looks in another view for what a view shows: is it there, where it would be if it stood still?
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth and normals of a view; planar depth of another one.
// Out: a flag where a surface is confirmed, and one where it is seen through. Flags of other views stay.
//
// A surface that stands still may be hidden in the other view, but the other view never sees through it. Its place is
// known to a pixel: of the 3 x 3 pixels there, one that shows its tangent plane confirms it, and it is seen through
// where each shows something farther.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/reprojection.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { StillParams params; };
readonly buffer Depth { float depth[]; };                 // one float per pixel of `from`, planar depth
readonly buffer Normal { uint normal[]; };                // one uint per pixel of `from`, see normal.glsl
readonly buffer WitnessDepth { float witness_depth[]; };  // one float per pixel of `to`, planar depth
// one uint per pixel of `from`: kFlagConfirmed and kFlagSeenThrough, zeroed before the first view
buffer Flags { uint flags[]; };

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const View from = params.by.from, to = params.by.to;
  if (!inside(from, pixel)) return;
  const int index = index_of(from, pixel);
  if (depth[index] >= kSkyDepth) return;
  const vec3 position = position_there(params.by, position_of(from, vec2(pixel) + 0.5, depth[index]));
  const vec3 n = direction_there(params.by, unpack_normal(normal[index]));
  const float z = -position.z;
  const ivec2 place = pixel_of(to, position);
  if (!(z > 0.0) || !inside(to, place)) return;

  const float separation = separation_at(params.by, z);
  bool is_confirmed = false;
  float nearest = kSkyDepth;
  for (int y = -1; y <= 1; y++) {
    for (int x = -1; x <= 1; x++) {
      const ivec2 at = clamp(place + ivec2(x, y), ivec2(0), to.size - 1);
      const float seen = witness_depth[index_of(to, at)];
      is_confirmed = is_confirmed || abs(plane_depth(to, vec2(at) + 0.5, position, n) - seen) <= separation;
      nearest = min(nearest, seen);
    }
  }
  flags[index] |= (is_confirmed ? kFlagConfirmed : 0u) | (nearest > z + separation ? kFlagSeenThrough : 0u);
}
