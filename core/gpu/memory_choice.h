// Chooses the type of memory that a buffer lies in: a pure function of the table that the device gives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <optional>

namespace alcove::gpu {

/// Who touches the memory.
enum class MemoryUse {
  kernels,  // the fastest for kernels; where the host caches that memory too, the one that the host reaches
  host,     // the host reads and writes it, and copies go between it and the memory of kernels
  both,     // kernels and the host touch the same bytes, however slow that is for kernels
};

struct MemoryType {
  std::uint32_t index;
  bool is_cached;  // the host reaches it, and reads it through its cache
};

/// The type that suits the use best; nullopt when none will do. `allowed`: a bit for every type that the buffer may lie
/// in. Types that need a feature which nobody enabled, as protected or device-coherent memory does, are never chosen.
///
/// The host reads what it has uploaded, to look for sky and to compare frames. Memory that it does not cache it reads
/// word by word, from a discrete GPU across the bus: 100 times slower. So such memory is never mapped for an upload;
/// a cached staging buffer and a copy take its place.
std::optional<MemoryType> choose_memory(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                                        MemoryUse use);

}  // namespace alcove::gpu
