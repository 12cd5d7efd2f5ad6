// The type of memory for each use, and buffers in it, with guards around them in tests.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/buffer.h"

#include <algorithm>
#include <span>

#include "core/base/error.h"

namespace alcove::gpu {

namespace {

constexpr VkMemoryPropertyFlags kDeviceLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kHostVisible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
/// Coherent memory needs no flush and no invalidation.
constexpr VkMemoryPropertyFlags kHostWritten = kHostVisible | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kHostRead = kHostWritten | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
/// The properties that need no feature of the device.
constexpr VkMemoryPropertyFlags kPlain = kDeviceLocal | kHostRead;

/// Properties that a type must have, and must not have.
struct Wish {
  VkMemoryPropertyFlags wanted = 0;
  VkMemoryPropertyFlags unwanted = 0;
};

// The wishes for each use, the best first. Device memory that the host sees but does not cache can be a small window,
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

namespace {

constexpr std::byte kUnwritten{0xff};  // four of them are a NaN

/// Buffers smaller than this are kept for any smaller size: that costs less than another allocation.
constexpr std::size_t kSmallBytes = 1 << 20;

/// While a frame is recorded, the host writes only a few numbers into buffers; it writes pixels before.
constexpr std::size_t kRehearsedBytes = 1 << 16;

/// The guard before and behind a buffer: the bytes of the options, and as many more as the device's alignment takes.
std::size_t guard_on(const Device& device) {
  const std::size_t step = std::size_t(device.block_alignment());
  return (device.options().guard_bytes + step - 1) / step * step;
}

double mebibytes(std::size_t bytes) { return double(bytes) / (1 << 20); }

}  // namespace

Buffer::Buffer(Device& device, std::size_t bytes, Use use)
    : bytes_(bytes), capacity_(bytes), guard_(guard_on(device)), use_(use) {
  if (bytes > device.info().buffer_bytes)
    fail(ErrorKind::device,
         "a frame this large needs a buffer of {:.0f} MiB, and {} takes {:.0f} MiB; compute a smaller frame or use "
         "another --device",
         mebibytes(bytes), device.info().name, mebibytes(device.info().buffer_bytes));
  if (guard_ > 0)
    place_between_guards(device);
  else
    place(device);
}

Buffer::Buffer(std::size_t bytes, Use use)
    : bytes_(bytes), capacity_(bytes), guard_(0), use_(use), rehearsed_(bytes <= kRehearsedBytes ? bytes : 0) {
  host_ = rehearsed_;
}

void Buffer::place(Device& device) {
  if (!allocate(device, MemoryUse::kernels, device_side_))
    throw OutOfMemory(ErrorKind::device, fmt::format("{} has no room for a buffer of {:.1f} MiB: end other programs "
                                                     "that use its memory, or use another --device",
                                                     device.info().name, mebibytes(bytes_)));
  if (device_side_.is_cached && device.options().map_memory) host_ = map(device, device_side_);
  if (use_ == Use::upload) make_staging(device);
}

void Buffer::place_between_guards(Device& device) {
  if (!allocate(device, MemoryUse::both, device_side_))
    fail(ErrorKind::device, "{} has no host memory for a guarded buffer of {:.1f} MiB", device.info().name,
         mebibytes(bytes_));
  guarded_ = map(device, device_side_);
  std::ranges::fill(guarded_, kUnwritten);
  host_ = guarded_.subspan(guard_, bytes_);
}

void Buffer::make_staging(Device& device) const {
  if (!host_.empty()) return;
  if (!allocate(device, MemoryUse::host, staging_side_))
    throw OutOfMemory(ErrorKind::device, fmt::format("no host memory for a staging buffer of {:.1f} MiB for {}",
                                                     mebibytes(capacity_), device.info().name));
  host_ = map(device, staging_side_);
}

bool Buffer::allocate(Device& device, MemoryUse use, Allocation& allocation) const {
  auto info = structure<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = capacity_ + 2 * guard_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT |
               VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  Allocation made;
  make(made.buffer, device.handle(), vkCreateBuffer, info, "vkCreateBuffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.handle(), made.buffer, &needs);
  const auto type = choose_memory(device.memory(), needs.memoryTypeBits, use);
  if (!type) return false;
  made.memory = device.allocate(needs.size, type->index);
  if (!made.memory) return false;
  made.is_cached = type->is_cached;
  check(vkBindBufferMemory(device.handle(), made.buffer, made.memory, 0), "vkBindBufferMemory");
  allocation = std::move(made);
  return true;
}

std::span<std::byte> Buffer::map(Device& device, const Allocation& allocation) const {
  void* data = nullptr;
  check(vkMapMemory(device.handle(), allocation.memory, 0, VK_WHOLE_SIZE, 0, &data), "vkMapMemory");
  return {static_cast<std::byte*>(data), capacity_ + 2 * guard_};
}

VkBufferView Buffer::texels(const Device& device, VkFormat format) const {
  auto& view = views_[format];
  if (view) return view;
  const VkDeviceSize texel_bytes = format == VK_FORMAT_R32G32B32A32_SFLOAT ? 4 * sizeof(float) : sizeof(float);
  auto info = structure<VkBufferViewCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO);
  info.buffer = handle();
  info.format = format;
  info.offset = guard_;
  info.range = std::min<VkDeviceSize>((capacity_ + guard_) / texel_bytes, device.most_texels()) * texel_bytes;
  make(view, device.handle(), vkCreateBufferView, info, "vkCreateBufferView");
  return view;
}

bool Buffer::suits(std::size_t bytes) const {
  if (bytes == bytes_) return true;
  return guard_ == 0 && bytes <= capacity_ && capacity_ <= std::max(2 * bytes, kSmallBytes);
}

bool Buffer::guards_hold() const {
  if (guard_ == 0) return true;
  const auto holds = [](std::span<const std::byte> guard) {
    return std::ranges::all_of(guard, [](std::byte byte) { return byte == kUnwritten; });
  };
  return holds(guarded_.first(guard_)) && holds(guarded_.last(guard_));
}

}  // namespace alcove::gpu
