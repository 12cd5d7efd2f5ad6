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
};

ListedPixel listed_pixel(uvec2 group, uint invocation) {
  ListedPlace place = listed_place(group, invocation);
  bool exists = place.tile < counts.listed;
  if (kSparse != 0u) {
    const uint at = pack_site(place.tile, place.pixel);
    exists = at < site_counts.listed;
    if (exists) place = unpack_site(sites[at]);
  }
  if (!exists) return ListedPixel(false, 0u, ivec2(0));
  const ivec2 pixel = pixel_of_tile(unpack_tile(list[place.tile]), place.pixel);
  return ListedPixel(inside(params.view, pixel), place.tile, pixel);
}
