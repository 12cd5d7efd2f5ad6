// The sites of blocks. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// The word of a block has a bit for each of its pixels, row by row from the lowest on: whether it is a site. A site's
// number is that of its bit times as many as there are blocks, and that of its block: most sites, which have the same
// bit, then lie together in memory.

const int kBlockPixels = kBlock * kBlock;

ivec2 place_in_block(int bit) { return ivec2(bit & 3, bit >> 2); }

/// The index of the word of a pixel's block.
int word_of_pixel(SiteGrid grid, ivec2 pixel) {
  const ivec2 block = (pixel + grid.overhang) / kBlock;
  return block.y * grid.blocks.x + block.x;
}

int number_of_site(SiteGrid grid, int block, int bit) { return bit * (grid.blocks.x * grid.blocks.y) + block; }

int bit_of_pixel(SiteGrid grid, ivec2 pixel) {
  const ivec2 place = (pixel + grid.overhang) % kBlock;
  return place.y * kBlock + place.x;
}

/// Whether a pixel is a site, by the word of its block.
bool is_site(SiteGrid grid, uint word, ivec2 pixel) { return (word >> uint(bit_of_pixel(grid, pixel)) & 1u) != 0u; }

/// The sites in a row of a block, by its word, as bits.
uint row_of_block(uint word, int y) { return word >> uint(y * kBlock) & (1u << uint(kBlock)) - 1u; }

/// `row` adds its bits to `bits`, so many places from the lowest on.
uint with_row(uint bits, uint row, int from) { return bits | (from < 0 ? row >> uint(-from) : row << uint(from)); }

/// The pixel of a site, by the site's number.
ivec2 pixel_of_site(SiteGrid grid, int number) {
  const int blocks = grid.blocks.x * grid.blocks.y, block = number % blocks;
  return ivec2(block % grid.blocks.x, block / grid.blocks.x) * kBlock - grid.overhang + place_in_block(number / blocks);
}
