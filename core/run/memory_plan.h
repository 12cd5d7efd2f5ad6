// How much memory the frames of a run may take, of the host and of the device, and how many of them that lets be
// computed at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/settings.h"
#include "core/gpu/device.h"
#include "core/run/tiles.h"

namespace alcove {

/// The bytes of host memory that all frames of a run may take together: settings.memory, or half of what is free, less
/// what the program itself needs.
std::uint64_t host_memory_for_frames(const DeviceSettings& settings);

/// What all frames of a run may take together.
struct RunMemory {
  std::uint64_t host_bytes = 0;
  std::uint64_t device_bytes = 0;  // of buffers in the device's own memory; without a limit where it is the host's
};
RunMemory memory_for_frames(const DeviceSettings& settings, const gpu::DeviceInfo& device);

/// The number of frames of so many pixels that the memory has room for, at least 1.
std::uint64_t frames_in(const RunMemory& memory, const PixelMemory& pixel, std::uint64_t pixels);

/// What each of `lanes` frames in flight may take.
Room room_of_lane(const RunMemory& memory, int lanes, const gpu::DeviceInfo& device);

}  // namespace alcove
