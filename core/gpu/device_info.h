// Facts about a device before it is used, the options that choose one, and the times of passes. This header needs no
// Vulkan.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace alcove::gpu {

/// The kinds of devices, in the order in which `auto` prefers them.
enum class DeviceType { discrete_gpu, integrated_gpu, virtual_gpu, other, cpu };

/// A Vulkan device of this machine, as `alcove devices` lists it.
struct DeviceInfo {
  std::uint32_t index;
  std::string name, uuid, driver, api_version;
  DeviceType type;
  std::uint64_t memory_bytes;  // of all device-local heaps
  std::uint64_t free_bytes;    // free bytes of the largest heap; all its bytes if the driver does not tell
  std::uint64_t buffer_bytes;  // the largest storage buffer
  std::string unusable;        // the reason why Alcove cannot compute on it; empty if it can
};
const char* name_of(DeviceType type);

/// The devices that the loader finds; empty if there are none. Fails only if the loader itself does.
std::vector<DeviceInfo> list_devices();

/// The version of the Vulkan loader, such as 1.3.239.
std::string loader_version();
/// The environment variables by which the loader and drivers choose devices and threads.
std::vector<std::string> driver_variables();

/// The longest time in ms that a submission may keep the device from others. A display on the same device stutters from
/// some 0.1 s on, and systems reset a device that does not answer for 2 s (Windows' default).
constexpr double kSubmissionMs = 250;

/// See DeviceOptions::lost_ms.
constexpr double kPatience = 20;

struct DeviceOptions {
  std::string choice = "auto";  // auto | cpu | an index | a name or a part of it | a UUID
  bool require_gpu = false;     // a CPU device is an error
  bool validate = false;        // load the validation layer; its messages are counted and printed to stderr
  // false: always copy through staging buffers, as with a device whose memory the host cannot map
  bool map_memory = true;
  // Whether kernels read buffers of texels where they can; nullopt: if the driver is much faster with them.
  std::optional<bool> texels = std::nullopt;
  // Guards for tests: at least so many bytes before and behind every buffer are NaN, and so are its own bytes
  // until they are written. A run that writes into a guard fails.
  std::size_t guard_bytes = 0;
  // A submission that has taken so long, and kPatience times as long as expected, is lost; not on a CPU device.
  double lost_ms = 30000;
  double submission_ms = kSubmissionMs;  // see kSubmissionMs; a CPU device has no limit unless this is changed
};

/// The time of one pass on the device, and the least bytes that it must move: each bound buffer once.
struct PassTime {
  std::string name;
  double ms = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;
};

}  // namespace alcove::gpu
