// Which pixel an invocation of an estimator is for: a site of the list, or a pixel of the listed tiles.
// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel has declared its parameters, kSparse, the buffers `list` and `counts` of tiles, and `sites` and
// `site_counts`.

/// A pixel that is to be estimated, and the tile it lies in.
struct ListedPixel {
  bool exists;
  uint tile;  // in the list
  ivec2 pixel;
  bool is_wide;  // a site of the widest lattice
};

ListedPixel listed_pixel(uvec2 group, uint invocation) {
  ListedPlace place = listed_place(group, invocation);
  bool exists = place.tile < counts.listed, is_wide = false;
  if (kSparse != 0u) {
    const uint at = pack_site(place.tile, place.pixel);
    exists = at < site_counts.listed;
    const uint site = exists ? sites[at] : 0u;
    if (exists) place = unpack_site(site);
    is_wide = (site & kWideSite) != 0u;
  }
  if (!exists) return ListedPixel(false, 0u, ivec2(0), false);
  const ivec2 pixel = pixel_of_tile(unpack_tile(list[place.tile]), place.pixel);
  return ListedPixel(inside(params.view, pixel), place.tile, pixel, is_wide);
}
