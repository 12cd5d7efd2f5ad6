// How much memory the frames of a run may take, of the host and of the device, and how many of them that lets be
// computed at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/settings.h"
#include "core/gpu/device.h"
#include "core/run/tiles.h"

namespace alcove {

/// What a run may take: as much as the user says, or half of what is free.
struct RunMemory {
  std::uint64_t program_bytes = 0;  // of host memory: the process with one lane, and without frames
  std::uint64_t lane_bytes = 0;     // of host memory: each further lane without its frame
  std::uint64_t host_bytes = 0;     // what is left for all frames of one lane
  std::uint64_t device_bytes = 0;   // of buffers in the device's own memory; without a limit where it is the host's
  bool is_chosen = false;           // the user has said how much
};

/// As long as the device is not known, it is taken for the CPU, which is what takes the most of the host's memory.
RunMemory memory_of_host(const DeviceSettings& settings);
RunMemory memory_for_frames(const DeviceSettings& settings, const gpu::DeviceInfo& device);

/// The number of frames of which this window is computed that the memory has room for, at least 1.
std::uint64_t frames_in(const RunMemory& memory, const FrameMemory& frame, const Window& computed);

/// What each of `lanes` frames in flight may take.
Room room_of_lane(const RunMemory& memory, int lanes, const gpu::DeviceInfo& device);

}  // namespace alcove
