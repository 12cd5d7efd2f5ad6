// Storage buffers, and the type of memory that each lies in. The host reaches a buffer directly if it caches the
// device's memory, and through a staging twin otherwise.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/gpu/device.h"

namespace alcove::gpu {

/// The users of a piece of memory.
enum class MemoryUse {
  kernels,  // kernels alone: the fastest for them; if the host caches some of that memory, the part that it reaches
  host,     // the host reads and writes it, and copies go between it and the memory of kernels
  both,     // kernels and the host touch the same bytes, however slow that is for kernels
};

struct MemoryType {
  std::uint32_t index;
  bool is_cached;  // the host reaches it, and reads it through its cache
};

/// The type of memory that suits the use best; nullopt if none does. `allowed` has a bit for every type that the buffer
/// may lie in. Types that need a feature which nobody enabled, as protected or device-coherent memory do, are never
/// chosen.
///
/// The host reads its own uploads, to look for sky and to compare frames. It reads uncached memory word by word, from a
/// discrete GPU across the bus: 100 times slower. So uncached memory is never mapped for an upload; a cached staging
/// buffer and a copy take its place.
std::optional<MemoryType> choose_memory(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                                        MemoryUse use);

/// The first writer of a buffer: kernels or the host. The host reads any buffer that was passed to
/// Recorder::download().
enum class Use { device, upload };

class Buffer {
 public:
  /// Fails with ErrorKind::device when the device cannot bind or hold that many bytes. bytes > 0.
  Buffer(Device& device, std::size_t bytes, Use use);
  /// A buffer of a rehearsal. It has host memory only if it is too small to hold pixels, and no device memory.
  Buffer(std::size_t bytes, Use use);

  std::size_t bytes() const { return bytes_; }
  /// The bytes that fit into its memory.
  std::size_t capacity() const { return capacity_; }
  Use use() const { return use_; }
  /// Whether it may be resized to so many bytes. A buffer that is much larger does not suit. Guards lie exactly behind
  /// the bytes, so a guarded buffer suits its own size only.
  bool suits(std::size_t bytes) const;
  /// Sets its size to so many bytes, which must suit. Their contents stay.
  void resize(std::size_t bytes) { bytes_ = bytes; }

  /// The bytes as the host sees them; empty while the buffer is neither mapped nor has a staging twin. Their address
  /// stays for the buffer's life.
  std::span<std::byte> host() const { return host_.first(host_.empty() ? 0 : bytes_); }
  template <class T>
  std::span<T> as() const {
    return {reinterpret_cast<T*>(host().data()), host().size() / sizeof(T)};
  }

  VkBuffer handle() const { return device_side_.buffer; }
  /// The part that kernels get: the bytes, and the guard behind them, so that a read beyond the end gives NaN.
  VkDescriptorBufferInfo bound() const { return {handle(), guard_, bytes_ + guard_}; }
  /// The same part as texels, one per word, or per four words, up to the device's limit of texels.
  VkBufferView texels(const Device& device, VkFormat format) const;
  /// False if something was written beside its bytes. Always true without guards: see DeviceOptions.
  bool guards_hold() const;
  /// The staging twin; null if the host maps the buffer itself, or if nobody has asked for a twin yet.
  VkBuffer staging() const { return staging_side_.buffer; }
  /// Makes the staging twin if it is needed and missing. The twin is not part of the buffer's value, so a const buffer
  /// can be downloaded.
  void make_staging(Device& device) const;

 private:
  struct Allocation {
    DeviceHandle<VkBuffer, vkDestroyBuffer> buffer;
    Memory memory;
    bool is_cached = false;
  };
  /// False if no memory of the device serves that use, or too little is left.
  bool allocate(Device& device, MemoryUse use, Allocation& allocation) const;
  std::span<std::byte> map(Device& device, const Allocation& allocation) const;
  void place(Device& device);
  void place_between_guards(Device& device);

  std::size_t bytes_, capacity_, guard_;
  Use use_;
  std::vector<std::byte> rehearsed_;
  Allocation device_side_;
  mutable Allocation staging_side_;
  mutable std::map<VkFormat, DeviceHandle<VkBufferView, vkDestroyBufferView>> views_;
  mutable std::span<std::byte> host_;  // of the whole capacity
  std::span<std::byte> guarded_;       // the bytes with their guards; empty without guards
};

}  // namespace alcove::gpu
