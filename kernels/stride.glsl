// Tells for which pixels an estimate is made, where it is not made for all. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// One pixel of `stride` (1, 2 or 4) in every row, at places that go from row to row in bit-reversed order, so that
// every row, every column and every block of stride x stride pixels has its share. They are counted from the display
// window's corner, `origin` pixels before the image's: a crop has those of the whole.

/// The first such pixel of a row.
int first_estimated(int row, ivec2 origin, int stride) {
  if (stride == 1) return 0;
  const uint place = bitfieldReverse(uint(row + origin.y)) >> uint(32 - findMSB(stride));
  return (int(place) - origin.x) & (stride - 1);
}

/// The pixels of an estimate, moved together: neighbours of these take successive points of the noise, not every second
/// or fourth.
ivec2 packed_place(ivec2 pixel, int stride) { return ivec2(pixel.x >> findMSB(stride), pixel.y); }
