// Tiles by what an estimator has to do for them: nothing for sky, nothing where nothing can block, else the directions in which something may.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: bounds of the tiles. Out: a list of the tiles that are left, and the visibility of the others' receivers, which is 1.
// The proof. Let a receiver p of a tile have the normal N and -N.P <= c. A surface point Q with depth z and N.Q = z m, m affine in the pixel, stands h = N.Q - N.P
// <= c + z m above p's tangent plane, so h / z <= c / z + m. Nothing blocks that rises by no more than `least` + z `rise` a pixel aside (clearance.glsl), that
// is, where (c - least) / z + m <= rise. With 1 / z below a plane of the other tile's bounds the left side is affine, and largest at a corner of it. Receivers
// whose normals are turned by d against N see d |Q - P| more at most. (Orthographic: -z for 1 / z, and no division.) What is farther than the radius from all
// receivers does not block either, where the estimator says so: by the distance of the boxes in space that hold the surfaces of both tiles.
// Constants below 1 and pads leave room for rounding.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "classify.h"
#include "view.glsl"
#include "normal.glsl"
#include "stride.glsl"
#include "clearance.glsl"
#include "tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(constant_id = kClassifyStrideId) const int kStride = 1;
layout(constant_id = kClassifyModeId) const uint kMode = kClassifySkips;
layout(scalar, push_constant) uniform Push { ClassifyParams params; };
layout(scalar, binding = kClassifyBounds) readonly buffer Bounds { TileBounds bounds[]; };
layout(scalar, binding = kClassifyDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kClassifyNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kClassifyList) writeonly buffer List { ListedTile list[]; };
layout(scalar, binding = kClassifyCounts) buffer Counts { TileCounts counts; };
layout(scalar, binding = kClassifyAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kClassifyBent) writeonly buffer Bent { float bent[]; };

/// With more tiles within reach than these, the search costs more than it saves.
const int kMostTiles = 1024;

const float kHalfTile = 0.5 * float(kTile - 1);

struct Box {
  vec3 least, most;  // tangents times depth, and depth
};

/// That holds what is seen in a tile between two depths.
Box box_of(View view, ivec2 tile, float near, float far) {
  const vec2 a = tangent_of(view, vec2(tile * kTile) + 0.5), b = tangent_of(view, vec2(min(tile * kTile + kTile, view.size)) - 0.5);
  const vec2 least = min(a, b), most = max(a, b), scale = view.orthographic != 0 ? vec2(1) : vec2(near, far);
  return Box(vec3(min(least * scale.x, least * scale.y), near), vec3(max(most * scale.x, most * scale.y), far));
}

float distance_sq(Box a, Box b) {
  const vec3 gap = max(max(a.least - b.most, b.least - a.most), 0.0);
  return dot(gap, gap);
}

/// Nearness as depth.
float depth_of(View view, float nearness) { return view.orthographic != 0 ? -nearness : 1.0 / nearness; }

struct Receivers {
  ivec2 tile;
  vec3 normal;
  float turned;
  float nearness, constant;  // factors: (c - least) and -N.z, or orthographic N.z and c - least
  float longest_ray;         // of unit depth
  float near, far;           // depths
  Box box;
  float reach_sq;
};

/// Whether nothing in that tile rises above the receivers' tangent planes.
bool is_below(View view, Receivers r, ivec2 other, vec2 gradient, float at_centre, float level, float farthest) {
  const vec2 centre = vec2(other * kTile) + 0.5 * float(kTile), along = r.nearness * gradient + r.normal.xy * view.tangent_per_pixel;
  const float most = r.nearness * at_centre + dot(r.normal.xy, tangent_of(view, centre)) + r.constant + kHalfTile * (abs(along.x) + abs(along.y));
  const ivec2 apart = abs(other - r.tile);
  const int tiles_apart = max(apart.x, apart.y);
  const float aside = max(float(kTile * (tiles_apart - 1)) + 0.5, 0.5), rounding = 2e-6 * abs(r.nearness * level);
  const vec2 farthest_aside = vec2((apart + 1) * kTile) * abs(view.tangent_per_pixel);
  const float lengthwise = view.orthographic != 0 ? max(-farthest - r.near, r.far + level) : r.longest_ray * max(abs(1.0 - r.near * farthest), abs(r.far * level - 1.0));
  return most <= 0.9 * least_rise(view) * aside - rounding - r.turned * (length(farthest_aside) + lengthwise);
}

/// The sectors in which something may block a receiver of the tile.
uint blocked_sectors(View view, ivec2 tile, TileBounds own) {
  const ivec2 count = tiles_of(view.size);
  const bool perspective = view.orthographic == 0;
  Receivers r;
  r.tile = tile;
  r.normal = unpack_normal(own.normal);
  r.turned = own.turned;
  r.near = depth_of(view, own.plane[kTilePlanes - 1u]);
  r.far = depth_of(view, own.farthest);
  r.box = box_of(view, tile, r.near, r.far);
  const vec2 widest = max(abs(r.box.least.xy), abs(r.box.most.xy)) / (perspective ? r.near : 1.0);
  r.longest_ray = perspective ? sqrt(1.0 + dot(widest, widest)) : 1.0;
  // A unit of depth is at least so much height at every receiver: their normals differ.
  const float height = (perspective ? own.lowest / r.far : r.normal.z) - own.turned * r.longest_ray;
  const float least = 0.9 * least_height(params.depth_precision, r.near, max(height, 0.0));
  r.nearness = perspective ? own.highest - least : r.normal.z;
  r.constant = perspective ? -r.normal.z : own.highest - least;

  // A sample lies up to half a pixel beside its slice, and is moved into it.
  const float pixel = max(abs(view.tangent_per_pixel.x), abs(view.tangent_per_pixel.y)), reach = params.radius + 2.0 * pixel * (perspective ? r.far + params.radius : 1.0);
  r.reach_sq = reach * reach;
  // The part of the image in which the sphere about any receiver is seen: all of it where one holds the eye.
  ivec2 first = ivec2(0), last = count - 1;
  const float nearest = r.near - reach, farthest = r.far + reach;
  if (!perspective || nearest > 0.01 * r.near) {
    const vec2 least_at = r.box.least.xy - reach, most_at = r.box.most.xy + reach;
    const vec2 a = perspective ? min(least_at / nearest, least_at / farthest) : least_at, b = perspective ? max(most_at / nearest, most_at / farthest) : most_at;
    const vec2 p = view.center + a / view.tangent_per_pixel, q = view.center + b / view.tangent_per_pixel;
    first = ivec2(clamp(floor((min(p, q) - 1.0) / float(kTile)), vec2(0), vec2(last)));
    last = ivec2(clamp(floor((max(p, q) + 1.0) / float(kTile)), vec2(0), vec2(last)));
  }

  uint sectors = 0u;
  const int many = (last.x - first.x + 1) * (last.y - first.y + 1);
  if (many > kMostTiles) return kEverySector;
  for (int y = first.y; y <= last.y && sectors != kEverySector; y++)
    for (int x = first.x; x <= last.x && sectors != kEverySector; x++) {
      const ivec2 other = ivec2(x, y);
      const int index = y * count.x + x;
      const float level = bounds[index].plane[kTilePlanes - 1u], far = bounds[index].farthest;
      bool harmless = far > level;
      if ((kMode & kClassifyRanged) != 0u) harmless = harmless || distance_sq(r.box, box_of(view, other, depth_of(view, level), depth_of(view, far))) > r.reach_sq;
      harmless = harmless || is_below(view, r, other, vec2(0), level, level, far) ||
                 is_below(view, r, other, bounds[index].gradient, bounds[index].plane[0], level, far);
      // An edge in it may be the end of a neighbour's surface.
      const ivec2 steps[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
      for (int k = 0; k < 4 && !harmless; k++) {
        const ivec2 beside = clamp(other + steps[k], ivec2(0), count - 1);
        harmless = is_below(view, r, other, bounds[beside.y * count.x + beside.x].gradient, bounds[index].plane[k + 1], level, far);
      }
      const vec2 offset = vec2((other - tile) * kTile);
      if (!harmless) sectors |= sectors_of_offsets(offset - float(kTile), offset + float(kTile));
    }
  return sectors;
}

void main() {
  const View view = params.view;
  const ivec2 tile = ivec2(gl_GlobalInvocationID.xy), count = tiles_of(view.size);
  if (any(greaterThanEqual(tile, count))) return;
  const TileBounds own = bounds[tile.y * count.x + tile.x];
  const bool skips = (kMode & kClassifySkips) != 0u, is_sky = skips && own.farthest > own.plane[kTilePlanes - 1u];
  if (tile == ivec2(0)) counts.groups.x = kListedRow, counts.groups.z = 1u;
  uint sectors = kEverySector;
  if (skips && !is_sky && own.normal != kNoNormal) sectors = blocked_sectors(view, tile, own);
  if (!is_sky && sectors != 0u) {
    const uint place = atomicAdd(counts.listed, 1u);
    list[place] = ListedTile(pack_tile(tile), sectors);
    atomicMax(counts.groups.y, rows_of_groups(place + 1u, kStride));
    return;
  }
  if (is_sky) atomicAdd(counts.sky, 1u);
  else atomicAdd(counts.open, 1u);
  const int plane = view.size.x * view.size.y;
  for (uint i = 0u; i < uint(kTile * kTile / kStride); i++) {
    const ivec2 pixel = pixel_of_tile(tile, i, params.origin, kStride);
    if (!inside(view, pixel)) continue;
    const int index = index_of(view, pixel);
    ao[index + int(params.plane) * plane] = 1.0;
    if ((kMode & kClassifyWithBent) != 0u) {
      const vec3 stored = depth[index] >= kSkyDepth ? stored_bent(vec3(0)) : stored_bent(open_bent(unpack_normal(normal[index])));
      for (int c = 0; c < 3; c++) bent[index + c * plane] = stored[c];
    }
  }
}
