// The order in which types of memory are preferred for each use.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/memory_choice.h"

#include <span>

namespace alcove::gpu {
namespace {

constexpr VkMemoryPropertyFlags kDeviceLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kHostVisible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
/// Coherent: nothing has to be flushed or invalidated.
constexpr VkMemoryPropertyFlags kHostWritten = kHostVisible | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kHostRead = kHostWritten | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
/// All properties that need no feature of the device.
constexpr VkMemoryPropertyFlags kPlain = kDeviceLocal | kHostRead;

/// Properties that a type must have, and must not have.
struct Wish {
  VkMemoryPropertyFlags wanted = 0;
  VkMemoryPropertyFlags unwanted = 0;
};

// The wishes for each use, from the best on. Device memory that the host sees but does not cache can be a small window,
// so plain device memory goes before it.
constexpr Wish kForKernels[] = {{kDeviceLocal | kHostRead}, {kDeviceLocal, kHostVisible}, {kDeviceLocal}};
constexpr Wish kForHost[] = {{kHostRead, kDeviceLocal}, {kHostRead}, {kHostWritten, kDeviceLocal}, {kHostWritten}};
constexpr Wish kForBoth[] = {{kDeviceLocal | kHostRead}, {kHostRead}, {kHostWritten}};

std::span<const Wish> wishes_for(MemoryUse use) {
  switch (use) {
    case MemoryUse::kernels: return kForKernels;
    case MemoryUse::host: return kForHost;
    case MemoryUse::both: break;
  }
  return kForBoth;
}

}  // namespace

std::optional<MemoryType> choose_memory(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                                        MemoryUse use) {
  for (const Wish& wish : wishes_for(use))
    for (std::uint32_t type = 0; type < memory.memoryTypeCount; type++) {
      const VkMemoryPropertyFlags flags = memory.memoryTypes[type].propertyFlags;
      const bool is_plain = (flags & ~kPlain) == 0;
      const bool is_wished = (flags & wish.wanted) == wish.wanted && (flags & wish.unwanted) == 0;
      if ((allowed >> type & 1) && is_plain && is_wished) return MemoryType{type, (flags & kHostRead) == kHostRead};
    }
  return std::nullopt;
}

}  // namespace alcove::gpu
