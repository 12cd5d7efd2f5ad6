// Buffer allocation: which memory type serves which use.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/buffer.h"

#include <algorithm>

#include "core/base/error.h"

namespace alcove::gpu {
namespace {

constexpr VkMemoryPropertyFlags kDeviceLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kHostWritten =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
/// Reading memory that the host does not cache goes word by word over the bus.
constexpr VkMemoryPropertyFlags kHostRead = kHostWritten | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

constexpr std::byte kUnwritten{0xff};  // four of them are a NaN

double mebibytes(std::size_t bytes) { return double(bytes) / (1 << 20); }

}  // namespace

Buffer::Buffer(Device& device, std::size_t bytes, Use use)
    : bytes_(bytes), guard_(device.options().guard_bytes), use_(use) {
  if (bytes > device.info().buffer_bytes)
    fail(ErrorKind::device,
         "a frame this large needs a buffer of {:.0f} MiB, and {} takes {:.0f} MiB; compute a smaller frame or use "
         "another --device",
         mebibytes(bytes), device.info().name, mebibytes(device.info().buffer_bytes));
  if (guard_ > 0) {
    if (!allocate(device, kDeviceLocal | kHostRead, device_side_) && !allocate(device, kHostRead, device_side_))
      fail(ErrorKind::device, "{} has no host memory for a guarded buffer of {:.1f} MiB", device.info().name,
           mebibytes(bytes));
    map(device, device_side_);
    return;
  }
  const VkMemoryPropertyFlags host = use == Use::upload ? kHostWritten : kHostRead;
  if (use != Use::device && device.options().map_memory && allocate(device, kDeviceLocal | host, device_side_)) {
    map(device, device_side_);
    return;
  }
  if (!allocate(device, kDeviceLocal, device_side_))
    throw OutOfMemory(
        ErrorKind::device,
        fmt::format(
            "{} has no room for a buffer of {:.1f} MiB; with less --memory a frame is computed in smaller tiles",
            device.info().name, mebibytes(bytes)));
  if (use == Use::device) return;
  if (!allocate(device, host, staging_side_) && !allocate(device, kHostWritten, staging_side_))
    throw OutOfMemory(ErrorKind::device, fmt::format("no host memory for a staging buffer of {:.1f} MiB for {}",
                                                     mebibytes(bytes), device.info().name));
  map(device, staging_side_);
}

bool Buffer::allocate(Device& device, VkMemoryPropertyFlags wanted, Allocation& allocation) const {
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes_ + 2 * guard_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer), "vkCreateBuffer");
  allocation.buffer = {device.handle(), buffer};
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.handle(), buffer, &needs);
  for (std::uint32_t type = 0; type < device.memory().memoryTypeCount; type++) {
    if (!(needs.memoryTypeBits >> type & 1) || (device.memory().memoryTypes[type].propertyFlags & wanted) != wanted)
      continue;
    VkMemoryAllocateInfo allocate_info{};
    allocate_info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate_info.allocationSize = needs.size;
    allocate_info.memoryTypeIndex = type;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    if (vkAllocateMemory(device.handle(), &allocate_info, nullptr, &memory) != VK_SUCCESS) continue;
    allocation.memory = {device.handle(), memory};
    check(vkBindBufferMemory(device.handle(), buffer, memory, 0), "vkBindBufferMemory");
    return true;
  }
  allocation.buffer = {};
  return false;
}

void Buffer::map(Device& device, const Allocation& allocation) {
  void* data = nullptr;
  check(vkMapMemory(device.handle(), allocation.memory, 0, VK_WHOLE_SIZE, 0, &data), "vkMapMemory");
  const std::span all(static_cast<std::byte*>(data), bytes_ + 2 * guard_);
  if (use_ != Use::device) host_ = all.subspan(guard_, bytes_);
  if (guard_ == 0) return;
  guarded_ = all;
  std::ranges::fill(guarded_, kUnwritten);
}

bool Buffer::guards_hold() const {
  if (guard_ == 0) return true;
  const auto holds = [](std::span<const std::byte> guard) {
    return std::ranges::all_of(guard, [](std::byte byte) { return byte == kUnwritten; });
  };
  return holds(guarded_.first(guard_)) && holds(guarded_.last(guard_));
}

}  // namespace alcove::gpu
