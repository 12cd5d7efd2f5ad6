// Divides what is free among the frames in flight.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/memory_plan.h"

#include <algorithm>

#include "core/base/system.h"

namespace alcove {
namespace {

// The process with one lane, and without frames: libraries, the driver, kernels and what compiles them. On lavapipe
// 110 to 165 MiB were measured, the most while the driver's cache is empty. Each further lane on the CPU has a driver
// of its own, which compiles the kernels again: 58 MiB.
constexpr std::uint64_t kProgramBytes = 176ull << 20;
constexpr std::uint64_t kCpuLaneBytes = 64ull << 20;
/// Command buffers and queues of a further lane on a GPU.
constexpr std::uint64_t kGpuLaneBytes = 8ull << 20;
/// What a GPU's driver may come to take of the host's memory after its device was made, for its compiler above all.
constexpr std::uint64_t kDriverBytes = 96ull << 20;

/// The part of the device's free memory that is planned for. The rest is for what drivers add to each of the some 40
/// buffers of a frame in flight, and for other programs that start later. Whoever still runs out computes fewer frames
/// at once, so that this number decides about speed alone.
constexpr double kPlannedPart = 0.75;

RunMemory memory_with(const DeviceSettings& settings, std::uint64_t program_bytes, std::uint64_t lane_bytes) {
  RunMemory memory;
  memory.program_bytes = program_bytes;
  memory.lane_bytes = lane_bytes;
  memory.is_chosen = settings.memory > 0;
  const std::uint64_t allowed = settings.memory ? settings.memory : free_memory() / 2;
  memory.host_bytes = std::max(settings.least_memory, allowed - std::min(allowed, program_bytes));
  memory.device_bytes = Room::kEndless;
  return memory;
}

}  // namespace

RunMemory memory_of_host(const DeviceSettings& settings) { return memory_with(settings, kProgramBytes, kCpuLaneBytes); }

RunMemory memory_for_frames(const DeviceSettings& settings, const gpu::DeviceInfo& device) {
  // A CPU device computes in host memory, which is counted already. An integrated GPU's memory is counted as both: its
  // driver may give away less of it than the host has.
  if (device.type == gpu::DeviceType::cpu) return memory_of_host(settings);
  RunMemory memory =
      memory_with(settings, std::max(kProgramBytes, resident_memory_bytes() + kDriverBytes), kGpuLaneBytes);
  memory.device_bytes = std::uint64_t(kPlannedPart * double(device.free_bytes));
  return memory;
}

std::uint64_t frames_in(const RunMemory& memory, const FrameMemory& frame, const Window& computed) {
  const FrameMemory::Bytes bytes = frame.of(computed);
  const std::uint64_t of_lane = bytes.host + memory.lane_bytes;
  const std::uint64_t on_host = (memory.host_bytes + memory.lane_bytes) / of_lane;
  const std::uint64_t on_device = memory.device_bytes / bytes.device;
  return std::max<std::uint64_t>(1, std::min(on_host, on_device));
}

Room room_of_lane(const RunMemory& memory, int lanes, const gpu::DeviceInfo& device) {
  const auto count = std::uint64_t(lanes);
  const std::uint64_t of_lanes = (count - 1) * memory.lane_bytes;
  Room room;
  room.bytes = (memory.host_bytes - std::min(memory.host_bytes, of_lanes)) / count;
  room.device_bytes = memory.device_bytes / count;
  room.buffer_bytes = device.buffer_bytes;
  room.program_bytes = memory.program_bytes;
  room.is_chosen = memory.is_chosen;
  return room;
}

}  // namespace alcove
