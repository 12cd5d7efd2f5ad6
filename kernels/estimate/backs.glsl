// How far back a pixel's surface is solid, by what else is seen of it, packed into a word. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Depths are held in widths of the pixel, so that a word tells the same at any scale of the scene, and of the radius.

/// What is seen along a line tells no more than so many times the width across it: the rod of a railing is not as deep
/// as the balcony below it.
const float kBackPerWidth = 1.5;

/// A number of at least a quarter in so many bits, of which four are its exponent; less and more are held to that.
uint pack_float(float x, int bits) {
  const int rest = 27 - bits;
  const uint half_a_step = 1u << rest - 1, least = 125u << 23;
  return min(floatBitsToUint(greater(x, 0.25)) + half_a_step - least >> rest, (1u << bits) - 1u);
}
float unpack_float(uint packed, int bits) { return uintBitsToFloat((packed << 27 - bits) + (125u << 23)); }

// An outline's depth is a pixel at least, so 0 is left for that there is none.
uint pack_mirrored(float depth) { return depth < 0.0 ? 0u : pack_float(greater(depth, 1.0), 6); }
float unpack_mirrored(uint word) { return (word & 63u) == 0u ? -1.0 : unpack_float(word & 63u, 6); }

float unpack_depth(uint word) { return unpack_float(word & 255u, 8); }

/// depth: of the front to the back. mirrored: the same by the rounded outline to the left, to the right, above and
/// below; below 0: there is none.
uint pack_back(float depth, vec4 mirrored) {
  return pack_float(depth, 8) | pack_mirrored(mirrored.x) << 8 | pack_mirrored(mirrored.y) << 14 |
         pack_mirrored(mirrored.z) << 20 | pack_mirrored(mirrored.w) << 26;
}

/// Where in a word the outline is told that lies towards a receiver from which samples go this way.
uint outline_of(vec2 direction) {
  const bool across = abs(direction.x) >= abs(direction.y);
  return across ? (direction.x > 0.0 ? 8u : 14u) : (direction.y > 0.0 ? 20u : 26u);
}

/// Chains are pixels of a row or a column that show one surface, each with the next. Lines are cut into segments, of
/// which two words tell, a bit for each pixel: whether it goes on from the one before; and whether a chain that begins
/// or ends with it has a rounded outline there.
struct Line {
  bool is_column;
  int number;  // the row, or the column
  int steps;   // pixels
  int first;   // segment of all
};

/// Of a row, and of a column.
ivec2 segments_of(View view) { return (view.size + kSegment - 1) / kSegment; }

Line line_of(View view, bool is_column, int number) {
  const ivec2 segments = segments_of(view);
  return is_column ? Line(true, number, view.size.y, view.size.y * segments.x + number * segments.y)
                   : Line(false, number, view.size.x, number * segments.x);
}

/// All rows, then all columns.
Line line_at(View view, int index) {
  const bool is_column = index >= view.size.y;
  return line_of(view, is_column, is_column ? index - view.size.y : index);
}
