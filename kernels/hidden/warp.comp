// Puts the surfaces that another view shows where a frame would see them, if they were not hidden.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, normals and use of the other view's pixels; the frame's first surface; what earlier rounds found.
// Out: for each pixel of the frame the nearest surface behind all that earlier rounds found, over all other views.
//
// Each pixel of the other view is a piece of its tangent plane, as large as the pixel and a little more, so that pieces
// of a bent surface overlap. It gives that plane's depth to the pixel centres of the frame that it covers: the four
// around it, which are all of them as long as it is no more than two pixels wide here.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/reprojection.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { WarpParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel of `from`, planar depth
readonly buffer Normal { uint normal[]; };  // one uint per pixel of `from`, see normal.glsl
readonly buffer Use { uint use[]; };        // one uint per pixel of `from`, 0 where it is used, see surfels.comp
readonly buffer First { float first[]; };   // one float per pixel of `to`, planar depth of the first surface
buffer Found { uint found[]; };             // planes of keys of `to`, zeroed before: see key_of()
buffer Counts { ViewCounts counts; };       // zeroed before

/// Half a piece's side, in pixels of its own view.
const float kHalfSide = 0.6;

/// The change of the two coordinates of an image point in `from`, in px, with its position: in scene units of `to`.
vec3 gradient_there(View from, vec3 position, ivec2 axis) {
  const vec2 per_unit = vec2(axis) / from.tangent_per_pixel;
  const float ahead = -position.z;
  return from.orthographic != 0
             ? direction_there(params.by, vec3(per_unit, 0))
             : direction_there(params.by, vec3(per_unit, dot(per_unit, position.xy) / ahead) / ahead);
}

/// The upper left of the four pixels of `to` whose centres are around a position.
ivec2 corner_of(View to, vec3 position) {
  const vec2 half_pixel = 0.5 * to.tangent_per_pixel * (to.orthographic != 0 ? 1.0 : -position.z);
  return pixel_of(to, vec3(position.xy - half_pixel, position.z));
}

/// The depth beyond which this round seeks: 0 beyond which is nothing.
float sought_beyond(int index, float shown) {
  if (params.round == 0u) return shown + separation_at(params.by, shown);
  const View to = params.by.to;
  const uint key = found[index + int(params.round - 1u) * to.size.x * to.size.y];
  const float last = depth_of(key);
  return key == 0u ? kSkyDepth : last + separation_at(params.by, last);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const View from = params.by.from, to = params.by.to;
  if (!inside(from, pixel)) return;
  const int index = index_of(from, pixel);
  const uint why_not = use[index];
  const bool is_counted = params.round == 0u && (why_not & (kFlagMoves | kFlagUnconfirmed)) != 0u;
  if (why_not != 0u && !is_counted) return;

  const vec3 seen = position_of(from, vec2(pixel) + 0.5, depth[index]);
  const vec3 position = position_there(params.by, seen);
  const ivec2 corner = corner_of(to, position);
  if (!(-position.z > 0.0) || any(lessThan(corner, ivec2(-1))) || any(greaterThanEqual(corner, to.size))) return;
  // Of a frame in tiles, each tile counts what would lie in it.
  if (is_counted) {
    if (why_not == kFlagMoves) atomicAdd(counts.moved, 1u);
    if (why_not == kFlagUnconfirmed) atomicAdd(counts.unconfirmed, 1u);
    return;
  }
  const vec3 n = direction_there(params.by, unpack_normal(normal[index]));
  const vec3 gradient_x = gradient_there(from, seen, ivec2(1, 0)), gradient_y = gradient_there(from, seen, ivec2(0, 1));
  const int plane = int(params.round) * to.size.x * to.size.y;
  uint covered = 0u, before = 0u;
  for (int i = 0; i < 4; i++) {
    const ivec2 at = corner + ivec2(i & 1, i >> 1);
    if (!inside(to, at)) continue;
    const float z = plane_depth(to, vec2(at) + 0.5, position, n);
    const vec3 from_center = position_of(to, vec2(at) + 0.5, z) - position;
    if (!(z > 0.0 && abs(dot(gradient_x, from_center)) <= kHalfSide && abs(dot(gradient_y, from_center)) <= kHalfSide))
      continue;
    const int there = index_of(to, at);
    const float shown = first[there];
    covered++;
    if (z < shown - separation_at(params.by, z)) before++;
    if (shown < kSkyDepth && z > sought_beyond(there, shown)) atomicMax(found[plane + there], key_of(z));
  }
  if (params.round == 0u && covered > 0u && before == covered) atomicAdd(counts.moved, 1u);
}
