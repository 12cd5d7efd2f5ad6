// Tiles of pixels by which work is skipped, and lattices of pixels with an estimate of their own. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

// The lattice of spacing 16 has one pixel of every 4 x 4. Those of 8, 4, 2 and 1 each hold the former and as many
// pixels again: every second pixel of every fourth row, every second pixel of every second row, the pixels of one
// colour of a chess board, and all. Pixels are counted from the display window's corner, so that a crop has the lattice
// of the whole. On them lie the sites that every density has: pixels with an estimate of their own.

/// The lattice in a row of 32 pixels, bit by bit. first: of the row, from the display window's corner.
uint lattice_row(ivec2 first, int spacing) {
  const int y = first.y & 3;
  uint row = spacing >= 16 ? 0x11111111u : 0x55555555u;
  if (spacing >= 8 && y != 0 || spacing == 4 && (y & 1) != 0) row = 0u;
  if (spacing == 2 && (y & 1) != 0) row = 0xaaaaaaaau;
  if (spacing == 1) row = ~0u;
  const uint turn = uint(first.x & 3);
  return row >> turn | row << ((32u - turn) & 31u);
}

/// The workgroups in x and y of a dispatch of so many.
uvec2 dispatch_of(uint groups) { return uvec2(min(groups, kListedRow), (groups + kListedRow - 1u) / kListedRow); }

ivec2 tiles_of(ivec2 size) { return (size + kTile - 1) / kTile; }

ivec2 blocks_of(ivec2 size) { return (tiles_of(size) + kTileBlock - 1) / kTileBlock; }

/// Packs a listed tile: column + (row << 16), in tiles, and kTileLayered or not.
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

/// The pixel that an invocation is for, of those of all listed tiles.
ListedPlace listed_place(uvec2 group, uint invocation) {
  const uint place = (group.y * kListedRow + group.x) * (kGroupX * kGroupY) + invocation;
  return ListedPlace(place / kTilePixels, place % kTilePixels);
}

/// Packs a site: such a pixel in one word.
uint pack_site(uint tile, uint pixel) { return tile * kTilePixels + pixel; }
ListedPlace unpack_site(uint site) { return ListedPlace(site / kTilePixels, site % kTilePixels); }

ivec2 pixel_of_tile(ivec2 tile, uint pixel) { return tile * kTile + ivec2(pixel % uint(kTile), pixel / uint(kTile)); }

/// The number of tiles if they count from the display window's corner, `origin` pixels before the image's, so that
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
