// Makes planar depth of a plane of surfaces behind the first, as a file holds them.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: raw depth, planar depth of the first surface.
// Out: planar depth > 0, below 0 of a surface that closes the solid before it; kSkyDepth where there is none.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/hidden/hidden.h"
#include "kernels/base/view.glsl"
#include "kernels/base/depth_terms.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = 0) const uint kForm = kDepthLinear;     // one of kDepth*
layout(constant_id = 1) const uint kKind = kBehindSurfaces;  // one of kBehind*
layout(scalar, push_constant) uniform Push { BehindParams params; };
readonly buffer Raw { float raw[]; };       // planes of floats, as in the files
readonly buffer Depth { float depth[]; };   // one float per pixel, planar depth of the first surface, from prepare
writeonly buffer Found { float found[]; };  // planes of floats, as layers takes them

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);
  const int at = index + int(params.plane) * params.view.size.x * params.view.size.y;
  const float z = planar_depth(kForm, params.depth, params.view, pixel, vec3(raw[at], 0, 0));
  const float whole = kKind == kBehindThickness ? depth[index] + z : z;
  const bool exists = z < kSkyDepth && whole < kSkyDepth && depth[index] < kSkyDepth;
  found[at] = exists ? (kKind == kBehindSurfaces ? whole : -whole) : kSkyDepth;
}
