// Writes one number per pixel of what a frame holds on its way through the chain, for a picture of it; sky is
// kSkyDepth.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, and for some views a plane of values or a second set of normals.
// Out: the number.
//
// An edge is where a neighbour lies off the pixel's tangent plane: the denoisers and the upsampling stop there.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "debug.h"
#include "view.glsl"
#include "normal.glsl"
#include "arcs.glsl"
#include "stride.glsl"
#include "tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { DebugParams params; };
layout(scalar, binding = kDebugDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kDebugNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kDebugValues) readonly buffer Values { uint values[]; };
layout(scalar, binding = kDebugResult) writeonly buffer Result { float result[]; };

/// How far the farthest of the four neighbours lies off the tangent plane, as part of the pixel's depth; 1 at the sky.
float edge(ivec2 pixel, float z, vec3 n) {
  const vec3 position = position_of(params.view, vec2(pixel) + 0.5, z);
  float farthest = 0.0;
  for (int k = 0; k < 4; k++) {
    const ivec2 neighbor = pixel + ivec2(k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0);
    if (!inside(params.view, neighbor)) continue;
    const float other = depth[index_of(params.view, neighbor)];
    const vec3 away = position_of(params.view, vec2(neighbor) + 0.5, other) - position;
    farthest = max(farthest, other >= kSkyDepth ? 1.0 : abs(dot(n, away)) / z);
  }
  return farthest;
}

/// The value of a pixel; where only one pixel of the stride has any, the value of that to its left.
float value_at(ivec2 pixel) {
  const int begin = first_estimated(pixel.y, params.origin, params.stride);
  const int at = pixel.x - ((pixel.x - begin) & (params.stride - 1));
  return uintBitsToFloat(values[index_of(params.view, ivec2(at < 0 ? begin : at, pixel.y))]);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(params.view, pixel)) return;
  const int index = index_of(params.view, pixel);
  const float z = depth[index];
  if (z >= kSkyDepth) {
    result[index] = kSkyDepth;
    return;
  }
  const vec3 n = unpack_normal(normal[index]);
  float value = z;
  if (params.kind == kDebugValue) value = value_at(pixel);
  if (params.kind == kDebugViewZ) value = -z;
  if (params.kind == kDebugNormalZ) value = n.z;
  if (params.kind == kDebugTile)
    value = float(bitCount(values[(pixel.y / kTile) * tiles_of(params.view.size).x + pixel.x / kTile] & kEverySector)) /
            float(kSectorsOfTurn);
  if (params.kind == kDebugEdge) value = edge(pixel, z, n);
  if (params.kind == kDebugNormalAngle) {
    const vec3 other = unpack_normal(values[index]);
    value = degrees(angle_of(dot(n, other), length(cross(n, other))));
  }
  result[index] = value;
}
