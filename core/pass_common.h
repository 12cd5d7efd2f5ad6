// What the host functions of kernels share.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/passes.h"

namespace alcove {

inline std::size_t pixels_of(const View& view) { return std::size_t(view.size.x) * std::size_t(view.size.y); }
inline std::size_t plane_bytes(const View& view) { return pixels_of(view) * sizeof(float); }
inline uint planes_in(const gpu::Buffer& buffer, const View& view) { return uint(buffer.bytes() / plane_bytes(view)); }
inline gpu::Extent extent_of(const View& view) { return {uint(view.size.x), uint(view.size.y)}; }
inline uint groups_of(int pixels, uint size) { return (uint(pixels) + size - 1) / size; }
inline vec3 to_vec3(const std::array<double, 3>& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

/// The grid of blocks that the pixels of an estimate stand for: it begins at the display window's corner, so that a crop has the blocks of the whole.
struct BlockGrid {
  int factor;      // px of a block in x and in y
  ivec2 origin;    // blocks from the display window's corner to the first one of the data window
  ivec2 overhang;  // px of that one outside of the data window
  ivec2 size;      // blocks
};
BlockGrid block_grid(const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
