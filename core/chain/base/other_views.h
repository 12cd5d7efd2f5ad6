// What other frames of the shot, and other views of the same instant, see of what lies behind a frame's first surface.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "core/gpu/recorder.h"
#include "kernels/base/shared.h"

namespace alcove {

/// What another frame of the shot, or another view of the same instant, sees: its prepared depth and normals.
struct OtherView {
  View view{};
  // its view space -> this frame's: x' = dot(row.xyz, x) + row.w, scene units
  std::array<std::array<float, 4>, 3> to_here{};
  vec3 depth_precision{};               // of planar depth: see DepthPrecision
  const gpu::Buffer* depth = nullptr;   // a plane: planar, kSkyDepth for sky
  const gpu::Buffer* normal = nullptr;  // a plane of packed normals, in its own view space
  // a plane of uints, not 0 where it shows what moves or may move; null: nothing does
  const gpu::Buffer* moving = nullptr;
  std::uint64_t content = 0;  // a hash of all three planes; 0: nobody has made it
};

}  // namespace alcove
