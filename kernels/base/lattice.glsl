// Nested lattices of pixels, and words that say which pixels have an estimate of their own. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// The lattice of spacing 16 has one pixel of every 4 x 4. Those of 8, 4, 2 and 1 each hold the former and as many
// pixels again: every second pixel of every fourth row, every second pixel of every second row, the pixels of one
// colour of a chess board, and all. Pixels are counted from the display window's corner, so that a crop has the lattice
// of the whole. Rows without any site cost the filters little.
//
// A site is a pixel with an estimate of its own. A tile has 8 words, one per row of it; bit i of each byte is the i-th
// pixel of the row. From the lowest byte on: whether the pixel and the one to its right are one surface, whether it and
// the one below are, whether it is a surface, whether it is a site.

const uint kBelowByte = 8u, kSurfaceByte = 16u, kSiteByte = 24u;

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

/// Where the words of a tile begin.
int words_of_tile(ivec2 tile, ivec2 tiles) { return (tile.y * tiles.x + tile.x) * 8; }

/// The word of the row of a tile in which a pixel lies.
int word_of_pixel(ivec2 pixel, ivec2 tiles) { return words_of_tile(pixel / kTile, tiles) + pixel.y % kTile; }

/// Whether the pixel in this column of the image is a site, by the word of its row.
bool is_site(uint word, int x) { return (word >> kSiteByte + uint(x % kTile) & 1u) != 0u; }
