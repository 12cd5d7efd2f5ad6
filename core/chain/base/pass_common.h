// What the host functions of kernels share: sizes of planes, and counts of workgroups.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/gpu/recorder.h"
#include "kernels/base/shared.h"

namespace alcove {

// They stand before the names of the buffers of further planes; those of the AO have none.
inline constexpr const char* kScalesPrefix = "scales ";
inline constexpr const char* kBentPrefix = "bent ";

inline std::size_t pixels_of(const View& view) { return std::size_t(view.size.x) * std::size_t(view.size.y); }
inline std::size_t plane_bytes(const View& view) { return pixels_of(view) * sizeof(float); }
inline uint planes_in(const gpu::Buffer& buffer, const View& view) { return uint(buffer.bytes() / plane_bytes(view)); }
inline gpu::Extent extent_of(const View& view) { return {uint(view.size.x), uint(view.size.y)}; }
inline uint groups_of(int pixels, uint size) { return (uint(pixels) + size - 1) / size; }
inline vec3 to_vec3(const std::array<double, 3>& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

}  // namespace alcove
