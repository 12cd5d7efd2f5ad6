// Which Vulkan devices there are, what they lack, and which one a choice names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/gpu/device_info.h"

namespace alcove::gpu {

struct PhysicalDevice {
  VkPhysicalDevice handle;
  DeviceInfo info;
};

/// A Vulkan instance, with the validation layer where it is asked for; null when the loader finds no driver at all.
VkInstance make_instance(bool validate);

/// All devices, the useless ones too.
std::vector<PhysicalDevice> physical_devices(VkInstance instance);

/// The device that the options ask for; `auto` prefers discrete GPUs, and takes a CPU last. Fails with
/// ErrorKind::device when none fits, naming those that there are.
PhysicalDevice choose_device(const std::vector<PhysicalDevice>& devices, const DeviceOptions& options);

struct QueueFamily {
  std::uint32_t index;
  std::uint32_t timestamp_bits;  // 0: it has no timestamps
};
/// The first queue family that computes; nullopt when none does.
std::optional<QueueFamily> compute_family(VkPhysicalDevice device);

bool has_extension(VkPhysicalDevice device, const char* name);

}  // namespace alcove::gpu
