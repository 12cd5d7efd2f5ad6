// Planes of a frame's pixels: their sizes, the workgroups over them, and those of the visibility.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>

#include "core/gpu/recorder.h"
#include "kernels/base/shared.h"

namespace alcove {

// Prefixes of the names of buffers of further planes; those of the AO have none.
inline constexpr const char* kScalesPrefix = "scales ";
inline constexpr const char* kMomentsPrefix = "moments ";

inline std::size_t pixels_of(const View& view) { return std::size_t(view.size.x) * std::size_t(view.size.y); }
inline std::size_t plane_bytes(const View& view) { return pixels_of(view) * sizeof(float); }
inline uint planes_in(const gpu::Buffer& buffer, const View& view) { return uint(buffer.bytes() / plane_bytes(view)); }
inline gpu::Extent extent_of(const View& view) { return {uint(view.size.x), uint(view.size.y)}; }
inline uint groups_of(int pixels, uint size) { return (uint(pixels) + size - 1) / size; }
/// Tiles in x and y.
inline gpu::Extent tile_extent(const View& view) {
  return {groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
}
/// The workgroups over a list, by the counts of the kernel that makes it; there are never more than `most`.
inline gpu::Extent listed_extent(const gpu::Buffer& counts, uint most) {
  return {counts, std::min(most, kListedRow), groups_of(int(most), kListedRow)};
}
inline vec3 to_vec3(const std::array<double, 3>& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

/// The planes of moments up to an order: see moments.glsl.
inline constexpr std::size_t moments_in(uint order) { return order == 0 ? 0 : order == 1 ? 3 : 8; }

/// The planes of an AOV of curvature: that of the only radius, or the mean and one for each.
inline constexpr std::size_t planes_of_curvature(std::size_t radii) { return radii > 1 ? 1 + radii : 1; }

/// The visibility between two passes.
struct Visibility {
  gpu::Buffer* ao = nullptr;      // a plane; of several radii the mean
  gpu::Buffer* scales = nullptr;  // a plane for each radius; null: one radius, or not asked for
  // planes of moments of the blocked directions, of the largest radius: see moments.glsl; then with curvature two for
  // each radius: the parts that the own surface leaves open inside and outside; null: not asked for
  gpu::Buffer* moments = nullptr;
};

}  // namespace alcove
