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
const bool kSkips = (kMode & kClassifySkips) != 0u, kProves = (kMode & kClassifyProves) != 0u;
layout(scalar, push_constant) uniform Push { ClassifyParams params; };
layout(scalar, binding = kClassifyBounds) readonly buffer Bounds { TileBounds bounds[]; };
layout(scalar, binding = kClassifyDepth) readonly buffer Depth { float depth[]; };
layout(scalar, binding = kClassifyNormal) readonly buffer Normal { uint normal[]; };
layout(scalar, binding = kClassifyList) writeonly buffer List { ListedTile list[]; };
layout(scalar, binding = kClassifyCounts) buffer Counts { TileCounts counts; };
layout(scalar, binding = kClassifyAo) writeonly buffer Ao { float ao[]; };
layout(scalar, binding = kClassifyBent) writeonly buffer Bent { float bent[]; };
layout(scalar, binding = kClassifySectors) writeonly buffer Sectors { uint sectors_of_tile[]; };

/// With more tiles within reach than these, the search costs more than it saves.
const int kMostTiles = 1024;

/// Receivers are taken together in blocks of so many tiles in x and y where all lie on one plane. A row of invocations has a block, and shares what it finds.
const int kBlock = 2;
shared uint found[kGroupY], surfaces[kGroupY];
const uint kAllTiles = (1u << (kBlock * kBlock)) - 1u;

const uint kLevel = kTilePlanes - 1u;
const float kFar = 1e30;
const float kHalfTile = 0.5 * float(kTile - 1);

ivec2 tile_of_block(ivec2 first, int i) { return first + ivec2(i % kBlock, i / kBlock); }

struct Box {
  vec3 least, most;  // tangents times depth, and depth
};

/// That holds what is seen in so many tiles in x and y between two depths.
Box box_of(View view, ivec2 tile, int tiles, float near, float far) {
  const vec2 a = tangent_of(view, vec2(tile * kTile) + 0.5), b = tangent_of(view, vec2(min((tile + tiles) * kTile, view.size)) - 0.5);
  const vec2 least = min(a, b), most = max(a, b), scale = view.orthographic != 0 ? vec2(1) : vec2(near, far);
  return Box(vec3(min(least * scale.x, least * scale.y), near), vec3(max(most * scale.x, most * scale.y), far));
}

float distance_sq(Box a, Box b) {
  const vec3 gap = max(max(a.least - b.most, b.least - a.most), 0.0);
  return dot(gap, gap);
}

/// Nearness as depth.
float depth_of(View view, float nearness) { return view.orthographic != 0 ? -nearness : 1.0 / nearness; }

/// Of the receivers of a block, as of those of a tile.
struct Shared {
  float nearest, farthest;
  uint normal;
  float turned, lowest, highest;
};

struct Receivers {
  vec2 along;              // of the affine part, a pixel
  float nearness, affine;  // factor of 1 / z: (c - least), or orthographic of -z: N.z; the affine part at pixel (0, 0)
  float turned;            // times the farthest that anything that may block is from a receiver, in units of the left side
  float turned_by_nearness;
};

/// The most that anything in a tile before a plane rises above the receivers' tangent planes.
float most_above(Receivers r, vec2 centre, vec2 gradient, float at_centre) {
  const vec2 along = r.nearness * gradient + r.along;
  return r.nearness * at_centre + r.affine + dot(r.along, centre) + kHalfTile * (abs(along.x) + abs(along.y));
}

/// Finds the sectors in which something may block a receiver of the block, with all invocations of its row.
void find_sectors(View view, ivec2 tile, Shared own) {
  const uint row = gl_LocalInvocationID.y;
  const ivec2 count = tiles_of(view.size), last = count - 1;
  const bool perspective = view.orthographic == 0, ranged = (kMode & kClassifyRanged) != 0u;
  const vec3 n = unpack_normal(own.normal);
  const float near = depth_of(view, own.nearest), far = depth_of(view, own.farthest);
  const Box box = box_of(view, tile, kBlock, near, far);
  const vec2 widest = max(abs(tangent_of(view, vec2(0))), abs(tangent_of(view, vec2(view.size))));
  const float longest_ray = perspective ? sqrt(1.0 + dot(widest, widest)) : 1.0;
  // A sample lies up to half a pixel beside its slice, and is moved into it.
  const float pixel = max(abs(view.tangent_per_pixel.x), abs(view.tangent_per_pixel.y)), reach = params.radius + 2.0 * pixel * (perspective ? far + params.radius : 1.0);
  const float reach_sq = reach * reach;

  // A unit of depth is at least so much height at every receiver: their normals differ.
  const float height = (perspective ? own.lowest / far : n.z) - own.turned * longest_ray;
  const float least = 0.9 * least_height(params.depth_precision, near, max(height, 0.0));
  Receivers r;
  r.along = n.xy * view.tangent_per_pixel;
  r.nearness = perspective ? own.highest - least : n.z;
  r.affine = dot(n.xy, tangent_of(view, vec2(0.5))) + (perspective ? -n.z : own.highest - least);
  // |Q - P| is at most the reach, or, where nothing is too far to block, |Q| + |P|; over z in perspective.
  r.turned = own.turned * (perspective ? (ranged ? 0.0 : longest_ray) : reach);
  r.turned_by_nearness = own.turned * (perspective ? (ranged ? reach : longest_ray * far) : 0.0);
  if (!perspective && !ranged && own.turned > 0.0) {
    found[row] = kEverySector;
    return;
  }

  // The part of the image in which the sphere about any receiver is seen: all of it where one holds the eye.
  ivec2 from = ivec2(0), to = last;
  const float nearest = near - reach, farthest = far + reach;
  if (!perspective || nearest > 0.01 * near) {
    const vec2 least_at = box.least.xy - reach, most_at = box.most.xy + reach;
    const vec2 a = perspective ? min(least_at / nearest, least_at / farthest) : least_at, b = perspective ? max(most_at / nearest, most_at / farthest) : most_at;
    const vec2 p = view.center + a / view.tangent_per_pixel, q = view.center + b / view.tangent_per_pixel;
    from = ivec2(clamp(floor((min(p, q) - 1.0) / float(kTile)), vec2(0), vec2(last)));
    to = ivec2(clamp(floor((max(p, q) + 1.0) / float(kTile)), vec2(0), vec2(last)));
  }
  const ivec2 extent = to - from + 1;
  if (extent.x * extent.y > kMostTiles) {
    found[row] = kEverySector;
    return;
  }

  // First the block and its neighbours, which decide most; then all, row by row.
  const float per_row = 1.0 / float(extent.x);  // times a number below kMostTiles: whole divisions are slow
  const float rise = 0.9 * least_rise(view);
  for (int i = int(gl_LocalInvocationID.x); i < 16 + extent.x * extent.y && found[row] != kEverySector; i += int(kGroupX)) {
    const int line = int((float(i - 16) + 0.5) * per_row);
    const ivec2 other = i < 16 ? clamp(tile - 1 + ivec2(i & 3, i >> 2), ivec2(0), last) : from + ivec2(i - 16 - line * extent.x, line);
    const int index = other.y * count.x + other.x;
    const float level = bounds[index].plane[kLevel], other_farthest = bounds[index].farthest;
    const ivec2 apart = max(tile - other, other - tile - (kBlock - 1));
    const float aside = max(float(kTile * (max(apart.x, apart.y) - 1)) + 0.5, 0.5);
    const float limit = rise * aside - 2e-6 * abs(r.nearness * level) - r.turned - r.turned_by_nearness * level;
    const vec2 centre = vec2(other * kTile) + kHalfTile;
    const float above = min(most_above(r, centre, vec2(0), level), most_above(r, centre, bounds[index].gradient, bounds[index].plane[0]));
    const bool too_far = ranged ? distance_sq(box, box_of(view, other, 1, depth_of(view, level), depth_of(view, other_farthest))) > reach_sq : false;
    bool harmless = other_farthest > level ? true : too_far ? true : above <= limit;
    // An edge in it may be the end of a neighbour's surface.
    const int planes = harmless ? 0 : int(bounds[index].mixed) * 8;
    for (int k = 0; k < planes && !harmless; k++) {
      const ivec2 beside = clamp(other + neighbor_step(k), ivec2(0), last);
      harmless = most_above(r, centre, bounds[beside.y * count.x + beside.x].gradient, bounds[index].plane[k + 1]) <= limit;
    }
    for (bool marks = !harmless; marks; marks = false) {
      const vec2 offset = vec2((other - tile) * kTile);
      atomicOr(found[row], sectors_of_offsets(offset - float(kBlock * kTile), offset + float(kTile)));
    }
  }
}

void list_tile(ivec2 tile, uint sectors) {
  const uint place = atomicAdd(counts.listed, 1u);
  list[place] = ListedTile(pack_tile(tile), sectors);
  atomicMax(counts.groups.y, rows_of_groups(place + 1u, kStride));
}

/// What estimators write where nothing blocks, by all invocations of a row.
void write_open(View view, ivec2 tile, bool is_sky) {
  if (gl_LocalInvocationID.x == 0u) atomicAdd(counts.sky, is_sky ? 1u : 0u), atomicAdd(counts.open, is_sky ? 0u : 1u);
  const int plane = view.size.x * view.size.y;
  for (uint i = gl_LocalInvocationID.x; i < uint(kTile * kTile / kStride); i += kGroupX) {
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

/// The receivers of a block of tiles.
Shared shared_by(ivec2 tile, ivec2 count) {
  Shared all = Shared(-kFar, kFar, kNoNormal, 0.0, kFar, -kFar);
  bool agree = true;
  for (int i = 0; i < kBlock * kBlock; i++) {
    const ivec2 part = tile_of_block(tile, i);
    const int index = min(part.y, count.y - 1) * count.x + min(part.x, count.x - 1);
    const float level = bounds[index].plane[kLevel], farthest = bounds[index].farthest;
    if (any(greaterThanEqual(part, count)) || farthest > level) continue;
    all.nearest = max(all.nearest, level);
    all.farthest = min(all.farthest, farthest);
    if (all.normal == kNoNormal) all.normal = bounds[index].normal;
    agree = agree && bounds[index].normal != kNoNormal && bounds[index].normal == all.normal;
    all.turned = max(all.turned, bounds[index].turned);
    all.lowest = min(all.lowest, bounds[index].lowest);
    all.highest = max(all.highest, bounds[index].highest);
  }
  if (!agree) all.normal = kNoNormal;
  return all;
}

void main() {
  const View view = params.view;
  const ivec2 count = tiles_of(view.size), tile = kBlock * ivec2(gl_WorkGroupID.x * kGroupY + gl_LocalInvocationID.y, gl_WorkGroupID.y);
  const uint row = gl_LocalInvocationID.y;
  // A surface in any of the tiles, as far as it must be known.
  if (gl_LocalInvocationID.x == 0u) surfaces[row] = kSkips ? 0u : kAllTiles;
  barrier();
  for (int i = 0; i < kTile * kBlock * kBlock && surfaces[row] != kAllTiles; i++) {
    const int part = i % (kBlock * kBlock);
    const ivec2 at = tile_of_block(tile, part) * kTile + ivec2(gl_LocalInvocationID.x, i / (kBlock * kBlock));
    if (depth[index_of(view, min(at, view.size - 1))] < kSkyDepth) atomicOr(surfaces[row], 1u << uint(part));
  }
  Shared own = Shared(0.0, 0.0, kNoNormal, 0.0, 0.0, 0.0);
  if (kProves && tile.x < count.x) own = shared_by(tile, count);
  if (gl_LocalInvocationID.x == 0u) found[row] = own.normal != kNoNormal ? 0u : kEverySector;
  barrier();
  if (own.normal != kNoNormal) find_sectors(view, tile, own);
  barrier();
  if (tile == ivec2(0)) counts.groups.x = kListedRow, counts.groups.z = 1u;
  const uint sectors = found[row];
  for (int i = 0; i < kBlock * kBlock; i++) {
    const ivec2 part = tile_of_block(tile, i);
    if (any(greaterThanEqual(part, count))) continue;
    const bool is_sky = (surfaces[row] >> uint(i) & 1u) == 0u;
    if (gl_LocalInvocationID.x == 0u) sectors_of_tile[part.y * count.x + part.x] = is_sky ? 0u : sectors;
    if (is_sky || sectors == 0u) write_open(view, part, is_sky);
    else if (gl_LocalInvocationID.x == 0u) list_tile(part, sectors);
  }
}
