// Divides what is free among the frames in flight.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/memory_plan.h"

#include <algorithm>

#include "core/base/memory_limit.h"

namespace alcove {
namespace {

// The process without frames: libraries, drivers, compiled kernels.
constexpr std::uint64_t kProgramBytes = 192ull << 20;

/// The part of the device's free memory that is planned for. The rest is for what drivers add to each of the some 40
/// buffers of a frame in flight, and for other programs that start later. Whoever still runs out computes fewer frames
/// at once, so that this number decides about speed alone.
constexpr double kPlannedPart = 0.75;

}  // namespace

std::uint64_t host_memory_for_frames(const DeviceSettings& settings) {
  const std::uint64_t allowed = settings.memory ? settings.memory : free_memory() / 2;
  return std::max(settings.least_memory, allowed - std::min(allowed, kProgramBytes));
}

RunMemory memory_for_frames(const DeviceSettings& settings, const gpu::DeviceInfo& device) {
  RunMemory memory;
  memory.host_bytes = host_memory_for_frames(settings);
  // A CPU device computes in host memory, which is counted already. An integrated GPU's memory is counted as both: its
  // driver may give away less of it than the host has.
  memory.device_bytes =
      device.type == gpu::DeviceType::cpu ? Room::kEndless : std::uint64_t(kPlannedPart * double(device.free_bytes));
  return memory;
}

std::uint64_t frames_in(const RunMemory& memory, const PixelMemory& pixel, std::uint64_t pixels) {
  const std::uint64_t on_host = memory.host_bytes / std::max<std::uint64_t>(1, pixel.bytes * pixels);
  const std::uint64_t on_device = memory.device_bytes / std::max<std::uint64_t>(1, pixel.device_bytes * pixels);
  return std::max<std::uint64_t>(1, std::min(on_host, on_device));
}

Room room_of_lane(const RunMemory& memory, int lanes, const gpu::DeviceInfo& device) {
  Room room;
  room.bytes = memory.host_bytes / std::uint64_t(lanes);
  room.device_bytes = memory.device_bytes / std::uint64_t(lanes);
  room.buffer_bytes = device.buffer_bytes;
  return room;
}

}  // namespace alcove
