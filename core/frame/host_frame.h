// A frame in host memory: for tests, benchmarks, the CPU reference and programs that link the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/frame/reading.h"

namespace alcove {

/// Depth and normals of one frame, rows from the top, over the data window.
struct HostFrame : Reading {
  // of depth_kind, positions: planes x, y, z; sky: at or beyond `sky`, or 0, infinite, NaN
  std::vector<float> depth;
  // planes x, y, z (or two, see kernels/geometry.h) in normal_space; empty: reconstructed from depth
  std::vector<float> normal;
  // planes of depth behind the first surface, in any order, as Reading::behind says; empty: none is known
  std::vector<float> behind_depth;
  int frame = 0;
};

/// Finds and reads the depth and normals that the settings name. Fails as find_frame() and read_planes() do.
HostFrame read_host_frame(const InputSettings& settings, int frame);

}  // namespace alcove
