// Where another frame looks for a surface of one, and cells of space near which things have moved. Pure: no bindings.
// After accumulate.h and reprojection.glsl.
// SPDX-License-Identifier: BSD-3-Clause

const float kLifted = 0.5;  // pixels' widths that what is seen through a surface is behind it at least

/// Pixels of a tile that are looked at for what is seen through them: one of each two in every second row, moved by one
/// from one such row to the next, so that each square of two by two pixels has one.
ivec2 looked_at(ivec2 square) { return square * 2 + ivec2(square.y & 1, 0); }

// From another frame's view space to the frame's, and back.
vec3 direction_here(NeighbourFrame other, vec3 v) { return other.row_x * v.x + other.row_y * v.y + other.row_z * v.z; }
vec3 position_here(NeighbourFrame other, vec3 p) { return direction_here(other, p - other.offset); }
vec3 direction_there(NeighbourFrame other, vec3 v) {
  return vec3(dot(other.row_x, v), dot(other.row_y, v), dot(other.row_z, v));
}
vec3 position_there(NeighbourFrame other, vec3 p) { return direction_there(other, p) + other.offset; }

/// The depth that a view should have at a position that it sees.
struct Sight {
  ivec2 at;      // its pixel, px
  bool is_seen;  // before the eye, and not at the picture's border
  float same;    // scene units: planar depth up to which what it has is the same surface
  float width;   // scene units: of a pixel there
};

/// error: that of both depths, see NeighbourFrame.
Sight sight_of(View view, vec3 position, vec3 error) {
  const ivec2 place = pixel_of(view, position);
  const bool is_seen = -position.z > 0.0 && all(greaterThan(place, ivec2(0))) && all(lessThan(place, view.size - 1));
  const float same = kPrecisions * error_at(error, -position.z) - position.z;
  return Sight(clamp(place, ivec2(0), view.size - 1), is_seen, same, pixel_width(view, -position.z));
}

// Cells of a frame's view space have words in a table that some of them share (Teschner et al., "Optimized Spatial
// Hashing for Collision Detection of Deformable Objects", 2003).

/// A position in widths of a cell, and the cell in which it lies.
vec3 in_cells(vec3 position, float radius) { return clamp(position / (kMovedCell * radius), -1e9, 1e9); }
ivec3 cell_of(vec3 position, float radius) { return ivec3(floor(in_cells(position, radius))); }

/// The index of the cell's word. All bits of the sum are mixed: of products joined bit by bit, cells on opposite sides
/// of the view's axis would share a word.
uint place_of_cell(ivec3 cell) {
  const uvec3 product = uvec3(cell) * uvec3(73856093u, 19349663u, 83492791u);
  const uint sum = product.x + product.y + product.z;
  return ((sum ^ sum >> 16) * 0x45d9f3bu >> 12) & (kMovedCells - 1u);
}
