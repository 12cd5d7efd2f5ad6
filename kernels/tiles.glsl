// Tiles of pixels by which work is skipped, and directions on the image. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

/// The workgroups in x and y of a dispatch of so many.
uvec2 dispatch_of(uint groups) { return uvec2(min(groups, kListedRow), (groups + kListedRow - 1u) / kListedRow); }

ivec2 tiles_of(ivec2 size) { return (size + kTile - 1) / kTile; }

ivec2 groups_of_tiles(ivec2 size) { return (tiles_of(size) + kTileGroup - 1) / kTileGroup; }

/// The step from a tile to the k-th of its 8 neighbours.
ivec2 neighbor_step(int k) { return k < 3 ? ivec2(k - 1, -1) : k < 6 ? ivec2(k - 4, 1) : ivec2(k * 2 - 13, 0); }

uint pack_tile(ivec2 tile) { return uint(tile.x) | uint(tile.y) << 16; }
ivec2 unpack_tile(uint place) { return ivec2(place & 0xffffu, (place & ~kTileLayered) >> 16); }

/// The workgroups in x and y of a dispatch over so many tiles, of which each takes so many invocations.
uvec2 dispatch_of_tiles(uint tiles, uint invocations) {
  return dispatch_of((tiles * invocations - 1u) / (kGroupX * kGroupY) + 1u);
}

/// Pixels of a tile count row by row.
const uint kTilePixels = uint(kTile * kTile);

/// A pixel of a listed tile, by the tile's number in the list.
struct ListedPlace {
  uint tile;  // in the list, or beyond its end
  uint pixel;
};

/// Which of the pixels of all listed tiles an invocation is for.
ListedPlace listed_place(uvec2 group, uint invocation) {
  const uint place = (group.y * kListedRow + group.x) * (kGroupX * kGroupY) + invocation;
  return ListedPlace(place / kTilePixels, place % kTilePixels);
}

/// Packs a site: such a pixel in one word.
uint pack_site(uint tile, uint pixel) { return tile * kTilePixels + pixel; }
ListedPlace unpack_site(uint site) { return ListedPlace(site / kTilePixels, site % kTilePixels); }

/// Packs a run of pixels that an invocation of a filter computes in each of kGroupX lines: the number of these lines,
/// and the number of the run in them.
uint pack_run(int lines, int run) { return uint(lines) | uint(run) << 16; }
ivec2 unpack_run(uint packed) { return ivec2(packed & 0xffffu, packed >> 16); }

ivec2 pixel_of_tile(ivec2 tile, uint pixel) { return tile * kTile + ivec2(pixel % uint(kTile), pixel / uint(kTile)); }

/// How many tiles there are if they count from the display window's corner, `origin` pixels before the image's, so that
/// a crop has those of the whole.
ivec2 anchored_tiles_of(ivec2 size, ivec2 origin) { return tiles_of(size + (origin & (kTile - 1))); }

ivec2 pixel_of_anchored_tile(ivec2 tile, uint pixel, ivec2 origin) {
  return pixel_of_tile(tile, pixel) - (origin & (kTile - 1));
}

/// The number of an invocation, of a dispatch with one for each tile. The invocations of a row of workgroups are
/// counted from the grid of tiles, since gl_NumWorkGroups counts those of one slice only.
uint invocation_of_tile(ivec2 tiles, uvec2 invocation) {
  const uint row = (uint(tiles.x) + kGroupX - 1u) / kGroupX * kGroupX;
  return invocation.y * row + invocation.x;
}

/// What the estimators store of a mean open direction. It lies in [0, 1], so that filters of visibility take it as it
/// is.
vec3 stored_bent(vec3 bent) { return 0.5 + 0.5 * bent; }

/// The mean open direction of an open hemisphere, whichever slices are drawn.
vec3 open_bent(vec3 normal) { return 2.0 / 3.0 * normal; }

/// Sixteen sectors of directions on the image, by a number that grows with the angle as that does: 0 to 4 for a whole
/// turn.
const uint kEverySector = 0xffffu;

float turn_of(vec2 direction) {
  const float y = direction.y / (abs(direction.x) + abs(direction.y));
  return direction.x >= 0.0 ? (y >= 0.0 ? y : 4.0 + y) : 2.0 - y;
}

uint sector_of(vec2 direction) { return uint(turn_of(direction) * float(kSectorsOfTurn / 4u)) & (kSectorsOfTurn - 1u); }

/// Packs a range of a ListedTile: its first and last step. A step is a pixel along the longer axis; a sample lies up to
/// half of one beside its offset.
uint pack_range(uint first, uint last) { return min(first, 0xffffu) | min(last, 0xffffu) << 16; }
uint first_of_range(uint range) { return range & 0xffffu; }
uint last_of_range(uint range) { return range >> 16; }
const uint kWholeRange = 0xffff0000u;

/// first_sample() begins so many samples early, for rounding. pow() is right within 2e-6 of itself (by the
/// precisions that Vulkan demands of exp2 and log2), which is less than this up to sample 5,000. Beyond, the half pixel
/// holds by which a range begins before what stands above.
const float kRoundingSamples = 0.01;

/// The sample with which a search may begin: one of those before the first step of the range, which stand above
/// nothing. The offsets of samples are k + 1, or where there are as many as wanted, so many pixels or ((k + jitter) /
/// steps)^exponent times the reach, if that is more.
int first_sample(uint range, int steps, int count, float reach, float jitter, float exponent) {
  const float before = float(first_of_range(range)) - 1.0, share = max(before, 0.0) / reach;
  const float k =
      float(steps) * (exponent == 2.0 ? sqrt(share) : pow(share, 1.0 / exponent)) - jitter - kRoundingSamples;
  return max(int(floor(count < steps ? before - 1.0 : min(before - 1.0, k))), 0);
}

/// The sectors in which a rectangle of offsets is seen; all of them where it holds the origin.
uint sectors_of_offsets(vec2 least, vec2 most) {
  if (all(lessThanEqual(least, vec2(0))) && all(greaterThanEqual(most, vec2(0)))) return kEverySector;
  const float middle = turn_of(0.5 * (least + most));
  float first = 0.0, last = 0.0;
  for (int corner = 0; corner < 4; corner++) {
    const float turn =
        turn_of(vec2((corner & 1) != 0 ? most.x : least.x, (corner & 2) != 0 ? most.y : least.y)) - middle;
    const float wrapped = turn - 4.0 * round(0.25 * turn);
    first = min(first, wrapped);
    last = max(last, wrapped);
  }
  const float sectors = float(kSectorsOfTurn / 4u);
  const int begin = int(floor((middle + first) * sectors));
  const int end = int(floor((middle + last) * sectors));
  const uint seen = ((2u << uint(end - begin)) - 1u) << (uint(begin) & (kSectorsOfTurn - 1u));
  return (seen | seen >> kSectorsOfTurn) & kEverySector;
}
