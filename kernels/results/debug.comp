// Writes one number per pixel of what a frame holds on its way through the chain, for a picture of it; sky is
// kSkyDepth.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, and for some views a plane of values or a second set of normals.
// Out: the number.
//
// An edge is where a neighbour lies off the pixel's tangent plane: the denoisers and the upsampling stop there, and
// at creases, which it does not show.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "kernels/results/results.h"
#include "kernels/base/view.glsl"
#include "kernels/base/normal.glsl"
#include "kernels/base/arcs.glsl"
#include "kernels/base/tiles.glsl"
#include "kernels/base/blocks.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { DebugParams params; };
readonly buffer Depth { float depth[]; };   // one float per pixel, planar depth, kSkyDepth for sky
readonly buffer Normal { uint normal[]; };  // one uint per pixel, unit vector in view space, see normal.glsl
// one float per pixel (kDebugValue) or a second set of normals (kDebugNormalAngle), or the kinds of tiles
// (kDebugTile), or what is hidden (kDebugHidden); not read by others
readonly buffer Values { uint values[]; };
readonly buffer Blocks { uint words[]; };     // one uint per block, see blocks.glsl; only if sparse
writeonly buffer Result { float result[]; };  // one float per pixel

/// The distance of the farthest of the four neighbours from the tangent plane, as part of the pixel's depth; 1 at the
/// sky.
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

bool has_site(ivec2 pixel) { return is_site(params.grid, words[word_of_pixel(params.grid, pixel)], pixel); }

/// A pixel's nearest site is sought so far around it, in px.
const int kFarthestSite = 4;

/// The value of a pixel; where only sites have any, that of the nearest one, of several the first row by row. Where
/// there is none, it is 0.
float value_at(ivec2 pixel) {
  if (params.sparse == 0u || has_site(pixel)) return uintBitsToFloat(values[index_of(params.view, pixel)]);
  const int side = 2 * kFarthestSite + 1;
  int nearest = side * side;
  float value = 0.0;
  for (int k = 0; k < side * side; k++) {
    const ivec2 away = ivec2(k % side, k / side) - kFarthestSite;
    const ivec2 site = pixel + away;
    const int distance = away.x * away.x + away.y * away.y;
    if (distance >= nearest || !inside(params.view, site)) continue;
    if (!has_site(site)) continue;
    nearest = distance;
    value = uintBitsToFloat(values[index_of(params.view, site)]);
  }
  return value;
}

/// The share of the pixels with an estimate of their own in the pixel's square of 4 x 4, which is counted from the
/// display window's corner.
float density_at(ivec2 pixel) {
  if (params.sparse == 0u) return 1.0;
  const ivec2 first = pixel - ((pixel + params.origin) & 3);
  int sites = 0, surfaces = 0;
  for (int k = 0; k < 16; k++) {
    const ivec2 at = first + ivec2(k & 3, k >> 2);
    if (!inside(params.view, at)) continue;
    surfaces += depth[index_of(params.view, at)] < kSkyDepth ? 1 : 0;
    sites += has_site(at) ? 1 : 0;
  }
  return float(sites) / float(surfaces);
}

/// The number of surfaces behind the first one, and half a one more where any of them closes a solid.
float hidden_at(int index) {
  const int plane = params.view.size.x * params.view.size.y;
  float count = 0.0, solid = 0.0;
  for (uint k = 0u; k < params.hidden; k++) {
    const float z = uintBitsToFloat(values[index + int(k) * plane]);
    count += z < kSkyDepth ? 1.0 : 0.0;
    solid = z < 0.0 ? 0.5 : solid;
  }
  return count + solid;
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
  if (params.kind == kDebugDensity) value = density_at(pixel);
  if (params.kind == kDebugViewZ) value = -z;
  if (params.kind == kDebugNormalZ) value = n.z;
  if (params.kind == kDebugTile)
    value = values[(pixel.y / kTile) * tiles_of(params.view.size).x + pixel.x / kTile] == kTileListed ? 1.0 : 0.0;
  if (params.kind == kDebugHidden) value = hidden_at(index);
  if (params.kind == kDebugEdge) value = edge(pixel, z, n);
  if (params.kind == kDebugNormalAngle) {
    const vec3 other = unpack_normal(values[index]);
    value = degrees(angle_of(dot(n, other), length(cross(n, other))));
  }
  result[index] = value;
}
