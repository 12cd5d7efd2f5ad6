// Bounds the surfaces that a group of tiles shows, by planes that none of them is before.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: bounds of the tiles.
// Out: bounds of groups of them, by which `classify` settles most of what is within reach at once.
//
// The gradient is the mean of those of the tiles. The plane with it is pushed towards the eye until no tile's own plane
// is before it anywhere in the tile.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "coarsen.h"
#include "tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { CoarsenParams params; };
layout(scalar, binding = kCoarsenTiles) readonly buffer Tiles { TileBounds tiles[]; };
layout(scalar, binding = kCoarsenGroups) writeonly buffer Groups { GroupBounds groups[]; };

const uint kLevel = kTilePlanes - 1u;
const float kFar = 1e30;

/// The plane is pushed on by this part of the sums' size, for rounding: 16 times the 2^-24 of one operation.
const float kPad = 1e-6;

void main() {
  const ivec2 group = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 count = tiles_of(params.size);
  const ivec2 groups_in = groups_of_tiles(params.size);
  if (any(greaterThanEqual(group, groups_in))) return;
  const ivec2 from = group * kTileGroup, to = min(from + kTileGroup, count);
  const vec2 centre = vec2(from * kTile) + 0.5 * float(kTileGroup * kTile - 1);
  vec2 gradient = vec2(0);
  float surfaces = 0.0;
  float level = -kFar;
  float last = kFar;
  float hidden = -kFar;
  for (int y = from.y; y < to.y; y++)
    for (int x = from.x; x < to.x; x++) {
      const int i = y * count.x + x;
      const bool is_sky = tiles[i].farthest > tiles[i].plane[kLevel];
      gradient += is_sky ? vec2(0) : tiles[i].gradient;
      surfaces += is_sky ? 0.0 : 1.0;
      level = max(level, tiles[i].plane[kLevel]);
      last = min(last, tiles[i].last);
      hidden = max(hidden, tiles[i].hidden);
    }
  gradient /= max(surfaces, 1.0);
  float plane = -kFar;
  for (int y = from.y; y < to.y; y++)
    for (int x = from.x; x < to.x; x++) {
      const int i = y * count.x + x;
      const vec2 offset = vec2(ivec2(x, y) * kTile) + 0.5 * float(kTile - 1) - centre;
      const vec2 turn = abs(tiles[i].gradient - gradient);
      const vec2 flat_turn = abs(gradient);
      const float half_side = 0.5 * float(kTile - 1);
      const float own = tiles[i].plane[0];
      const float tile_level = tiles[i].plane[kLevel];
      const float before =
          min(own + half_side * (turn.x + turn.y), tile_level + half_side * (flat_turn.x + flat_turn.y)) -
          dot(gradient, offset);
      const float size = abs(own) + abs(tile_level) + abs(gradient.x * offset.x) + abs(gradient.y * offset.y);
      plane = max(plane, tiles[i].farthest > tile_level ? -kFar : before + kPad * size);
    }
  groups[group.y * groups_in.x + group.x] = GroupBounds(gradient, plane, level, last, hidden);
}
