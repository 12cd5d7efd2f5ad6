// Cells of a frame's view space, in a table that some of them share. Pure: no bindings. After accumulate.h.
// SPDX-License-Identifier: BSD-3-Clause
//
// Teschner et al., "Optimized Spatial Hashing for Collision Detection of Deformable Objects", 2003.

/// The cell in which a position lies.
ivec3 cell_of(vec3 position, float radius) { return ivec3(floor(clamp(position / (kMovedCell * radius), -1e9, 1e9))); }

/// Where its word is.
uint place_of_cell(ivec3 cell) {
  const uvec3 product = uvec3(cell) * uvec3(73856093u, 19349663u, 83492791u);
  return (product.x ^ product.y ^ product.z) & (kMovedCells - 1u);
}
