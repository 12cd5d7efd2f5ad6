// Makes those pixels of a lattice sites that have too few sites of their own surface about them.
// SPDX-License-Identifier: BSD-3-Clause
//
// In: the words of tiles, see tiles.glsl, with the sites of the next wider lattice.
// Out: the same with those of this one.
//
// A pixel does without an estimate if the filters can give it one: if in three of the four quadrants about it a site
// lies within kReach pixels in x and in y, and a path leads there over pixels that are one surface, with one bend at
// most. On the wider lattices the path may not lead over a round surface, of which a site far away says nothing. What
// is beyond the image's border counts as a site. On the densest lattice it does not, and two quadrants will do, so that
// every pixel has a site of the image about it. All pixels of a row are decided at once, as bits of a word; an
// invocation decides three tiles, and reads kReach pixels beyond them.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "kernels/estimate/estimate.h"
#include "kernels/base/tiles.glsl"

layout(local_size_x = kGroupX, local_size_y = kGroupY) in;
layout(scalar, push_constant) uniform Push { SitesParams params; };
readonly buffer Rows { uint rows[]; };  // 8 words per tile, see tiles.glsl
// links over which a path may lead, as `rows` or without a bend, from links
readonly buffer Links { uint linked_rows[]; };
writeonly buffer Result { uint result[]; };  // as `rows`, with more sites

const int kReach = 3;                   // px
const int kCount = kTile + 2 * kReach;  // rows that are looked at
const int kBeside = 4;                  // px of the tiles on either side that are

struct Surroundings {
  uint right[kCount], below[kCount];  // linked
};

/// Pixels of three tiles in a row, and kBeside of their neighbours, as bits.
uint bits_of(uint words[kSitesTiles + 2], uint first) {
  uint bits = bitfieldExtract(words[0], int(first) + kTile - kBeside, kBeside);
  [[unroll]] for (int k = 0; k < kSitesTiles; k++) bits |= bitfieldExtract(words[k + 1], int(first), kTile)
                                                           << uint(kBeside + k * kTile);
  return bits | bitfieldExtract(words[kSitesTiles + 1], int(first), kBeside) << uint(kBeside + kSitesTiles * kTile);
}

// A row's sites, and what is linked to them up to kReach pixels to their right or left.
uint to_right(uint site, uint linked) {
  [[unroll]] for (int k = 0; k < kReach; k++) site |= (site & linked) << 1;
  return site;
}
uint to_left(uint site, uint linked) {
  [[unroll]] for (int k = 0; k < kReach; k++) site |= site >> 1 & linked;
  return site;
}

void spread_right(inout uint site[kCount], Surroundings s) {
  [[unroll]] for (int y = 0; y < kCount; y++) site[y] = to_right(site[y], s.right[y]);
}

void spread_left(inout uint site[kCount], Surroundings s) {
  [[unroll]] for (int y = 0; y < kCount; y++) site[y] = to_left(site[y], s.right[y]);
}

// Sites come down as far from the rows above: `last` holds what came to the row before by 0, 1 and 2 pixels.
void spread_down(inout uint site[kCount], Surroundings s) {
  uvec3 last = uvec3(0);
  [[unroll]] for (int y = 0; y < kCount; y++) {
    const uvec3 next = last & (y > 0 ? s.below[max(y - 1, 0)] : 0u);
    last = uvec3(site[y], next.xy);
    site[y] |= next.x | next.y | next.z;
  }
}

void spread_up(inout uint site[kCount], Surroundings s) {
  uvec3 last = uvec3(0);
  [[unroll]] for (int y = kCount - 1; y >= 0; y--) {
    const uvec3 next = last & s.below[y];
    last = uvec3(site[y], next.xy);
    site[y] |= next.x | next.y | next.z;
  }
}

void main() {
  const ivec2 tiles = tiles_of(params.size);
  const ivec2 first = ivec2(gl_GlobalInvocationID.xy) * ivec2(kSitesTiles, 1);
  if (any(greaterThanEqual(first, tiles))) return;
  const ivec2 corner = first * kTile - ivec2(kBeside, kReach);
  const uint columns = ~0u >> uint(max(32 - (params.size.x - corner.x), 0)) & ~0u << uint(max(-corner.x, 0));
  const bool is_dense = params.spacing == 1;
  Surroundings s;
  uint site[kCount], outside[kCount], own[kTile];
  [[unroll]] for (int y = 0; y < kCount; y++) {
    const int line = clamp(corner.y + y, 0, params.size.y - 1);
    uint words[kSitesTiles + 2], links[kSitesTiles + 2];
    [[unroll]] for (int k = 0; k < kSitesTiles + 2; k++) {
      const ivec2 tile = ivec2(clamp(first.x + k - 1, 0, tiles.x - 1), line / kTile);
      const int at = words_of_tile(tile, tiles) + line % kTile;
      words[k] = rows[at];
      links[k] = linked_rows[at];
    }
    outside[y] = line == corner.y + y ? ~columns : ~0u;
    site[y] = bits_of(words, kSiteByte) & ~outside[y] | (is_dense ? 0u : outside[y]);
    s.right[y] = bits_of(links, 0u) | outside[y] | outside[y] >> 1;
    s.below[y] = bits_of(links, kBelowByte) | outside[y];
    if (y >= kReach && y < kReach + kTile) own[y - kReach] = bits_of(words, kSurfaceByte) & ~outside[y];
  }
  [[unroll]] for (int y = 0; y + 1 < kCount; y++) s.below[y] |= outside[y + 1];

  uint right[kCount] = site, left[kCount] = site, down[kCount] = site, up[kCount] = site;
  spread_right(right, s);
  spread_left(left, s);
  spread_down(down, s);
  spread_up(up, s);
  uint a[kCount] = right, b[kCount] = right, c[kCount] = left, d[kCount] = left;
  spread_down(a, s);
  spread_up(b, s);
  spread_down(c, s);
  spread_up(d, s);
  uint e[kCount] = down, f[kCount] = up, g[kCount] = down, h[kCount] = up;
  spread_right(e, s);
  spread_right(f, s);
  spread_left(g, s);
  spread_left(h, s);
  [[unroll]] for (int y = 0; y < kTile; y++) {
    const int k = y + kReach;
    const uint p = a[k] | e[k], q = b[k] | f[k], r = c[k] | g[k], t = d[k] | h[k];
    const uint three = p & q & (r | t) | r & t & (p | q);
    const uint two = p & q | r & t | (p | q) & (r | t);
    const uint lattice = lattice_row(corner + ivec2(0, k) + params.origin, params.spacing);
    const uint sites = (site[k] | lattice & ~(is_dense ? two : three)) & own[y];
    for (int tile = 0; tile < kSitesTiles; tile++) {
      if (first.x + tile >= tiles.x) continue;
      const int at = words_of_tile(first + ivec2(tile, 0), tiles) + y;
      result[at] =
          bitfieldInsert(rows[at], bitfieldExtract(sites, kBeside + tile * kTile, kTile), int(kSiteByte), kTile);
    }
  }
}
