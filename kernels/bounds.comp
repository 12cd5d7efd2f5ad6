// Bounds the surfaces that a tile of 8 x 8 pixels shows: by planes that none of them is before, and by the plane of its
// receivers where they have one in common.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: planar depth, view normals, depths of hidden surfaces.
// Out: bounds of every tile, for `classify`.
//
// A pyramid of depths alone cannot tell a floor from what stands on it, for within a tile the floor itself comes
// nearer. In 1 / z (orthographic: in z) planes are affine in the pixel, so a tile is bounded by planes. One lies along
// its own surface. As an edge in the tile may be the end of a neighbour's surface, others lie along the neighbours'
// surfaces. Each plane is pushed towards the eye until no pixel is before it, so that all are true whatever their
// gradient.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "bounds.h"
#include "view.glsl"
#include "normal.glsl"
#include "tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { BoundsParams params; };
layout(scalar, binding = kBoundsDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kBoundsNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kBoundsHidden) readonly buffer Hidden { float hidden[]; };
layout(scalar, binding = kBoundsTiles) writeonly buffer Tiles { TileBounds tiles[]; };

/// Receivers whose normals differ more than this share no plane.
const float kLeastTurn = 2e-3;

/// Surfaces are one plane if they leave it by no more than this part of their nearness: 64 times its rounding, 2^-24.
const float kFlat = 4e-6;

const float kFar = 1e30;
const int kNeighbors = 8;

float nearness(float z) { return params.view.orthographic != 0 ? -z : z < kSkyDepth ? 1.0 / z : 0.0; }

/// The gradient of the nearness from corner to corner of a tile; for a tile beside the image, that of the nearest.
vec2 gradient_of(ivec2 tile, ivec2 size) {
  const ivec2 first = clamp(tile, ivec2(0), tiles_of(size) - 1) * kTile;
  const ivec2 last = min(first + kTile, size) - 1;
  const float a = nearness(depth[first.y * size.x + first.x]);
  const float b = nearness(depth[first.y * size.x + last.x]);
  const float c = nearness(depth[last.y * size.x + first.x]);
  const float d = nearness(depth[last.y * size.x + last.x]);
  return 0.5 * vec2(b - a + d - c, c - a + d - b) / vec2(max(last - first, ivec2(1)));
}

/// The nearness of what is known behind the first surface of a pixel: the least, or what is given, and the largest. One
/// that closes a solid says something from the front of that on.
vec2 hidden_range(int index, float first) {
  vec2 range = vec2(first, -kFar);
  float before = first;
  for (uint k = 0u; k < params.hidden; k++) {
    const float z = hidden[index + int(k) * params.view.size.x * params.view.size.y], near = nearness(abs(z));
    const float begin = z < 0.0 ? before : near;
    range = abs(z) < kSkyDepth ? vec2(min(range.x, near), max(range.y, begin)) : range;
    before = near;
  }
  return range;
}

void main() {
  const View view = params.view;
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 size = view.size;
  const ivec2 count = tiles_of(size);
  if (any(greaterThanEqual(tile, count))) return;
  const ivec2 first = tile * kTile, end = min(first + kTile, size);
  const vec2 middle = vec2(first) + 0.5 * float(kTile - 1);
  const vec2 own = gradient_of(tile, size);
  vec2 gradient[kNeighbors];
  float plane[kNeighbors];
  for (int k = 0; k < kNeighbors; k++) {
    gradient[k] = gradient_of(tile + neighbor_step(k), size);
    plane[k] = -kFar;
  }
  const float along_first = nearness(depth[first.y * size.x + first.x]) + dot(own, middle - vec2(first));
  float along_own = -kFar;
  float level = -kFar;
  float farthest = kFar;
  float last = kFar;
  float nearest_hidden = -kFar;
  float deepest = 0.0;
  for (int y = first.y; y < end.y; y++)
    for (int x = first.x; x < end.x; x++) {
      const float z = depth[y * size.x + x], near = z < kSkyDepth ? nearness(z) : -kFar;
      const vec2 from_middle = vec2(x, y) - middle;
      const float over_own = near - dot(own, from_middle);
      along_own = max(along_own, over_own);
      deepest = min(deepest, z < kSkyDepth ? over_own - along_first : 0.0);
      for (int k = 0; k < kNeighbors; k++) plane[k] = max(plane[k], near - dot(gradient[k], from_middle));
      level = max(level, near);
      farthest = min(farthest, z < kSkyDepth ? near : kFar);
      const vec2 hidden_there = z < kSkyDepth ? hidden_range(y * size.x + x, near) : vec2(kFar, -kFar);
      last = min(last, hidden_there.x);
      nearest_hidden = max(nearest_hidden, hidden_there.y);
    }

  const ivec2 centre = min(first + kTile / 2, size - 1);
  const bool mixed = max(along_own - along_first, -deepest) > kFlat * abs(along_first);
  uint word = kNoNormal;
  float turned = 0.0;
  float lowest = kFar;
  float highest = -kFar;
  const uint central = normal[centre.y * size.x + centre.x];
  const vec3 n = unpack_normal(central);
  const bool is_surface = depth[centre.y * size.x + centre.x] < kSkyDepth;
  const uint receivers = is_surface ? kTilePixels : 0u;
  for (uint i = 0u; i < receivers; i++) {
    const ivec2 pixel = pixel_of_tile(tile, i);
    const int index = min(pixel.y, size.y - 1) * size.x + min(pixel.x, size.x - 1);
    const float z = depth[index];
    const bool counts = inside(view, pixel) ? z < kSkyDepth : false;
    const vec3 difference = unpack_normal(normal[index]) - n;
    const float height = -dot(n, position_of(view, vec2(pixel) + 0.5, z));
    turned = max(turned, counts ? dot(difference, difference) : 0.0);
    lowest = min(lowest, counts ? height : kFar);
    highest = max(highest, counts ? height : -kFar);
  }
  turned = sqrt(turned);
  if (is_surface && turned < kLeastTurn) word = central;
  TileBounds result;
  result.gradient = own;
  result.plane[0] = along_own;
  for (int k = 0; k < kNeighbors; k++) result.plane[k + 1] = plane[k];
  result.plane[kTilePlanes - 1u] = level;
  result.farthest = farthest;
  result.last = last;
  result.hidden = nearest_hidden;
  result.mixed = mixed ? 1u : 0u;
  result.normal = word;
  result.turned = turned;
  result.lowest = lowest;
  result.highest = highest;
  tiles[tile.y * count.x + tile.x] = result;
}
