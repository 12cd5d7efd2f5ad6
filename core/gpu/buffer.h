// A storage buffer. The host reaches it directly where it caches the device's memory, and through a staging twin
// elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/gpu/device.h"

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

/// Says who fills a buffer first, kernels or the host. The host reads any buffer that Recorder::download() was told of.
enum class Use { device, upload };

class Buffer {
 public:
  /// Fails with ErrorKind::device when the device cannot bind or hold that many bytes. bytes > 0.
  Buffer(Device& device, std::size_t bytes, Use use);
  /// A buffer of a rehearsal, with no memory but the host's, and with that only where it is too small to hold pixels.
  Buffer(std::size_t bytes, Use use);

  std::size_t bytes() const { return bytes_; }
  /// The bytes that it has room for.
  std::size_t capacity() const { return capacity_; }
  Use use() const { return use_; }
  /// Whether it may be resized to so many bytes. It does not suit when it is much larger than they are. Guards lie
  /// exactly behind the bytes, so a guarded buffer suits its own size only.
  bool suits(std::size_t bytes) const;
  /// Gives it so many bytes, which must suit. What is in them stays as it is.
  void resize(std::size_t bytes) { bytes_ = bytes; }

  /// The bytes as the host sees them; empty while the buffer is not mapped and has no staging twin. They stay at their
  /// place for the buffer's life.
  std::span<std::byte> host() const { return host_.first(host_.empty() ? 0 : bytes_); }
  template <class T>
  std::span<T> as() const {
    return {reinterpret_cast<T*>(host().data()), host().size() / sizeof(T)};
  }

  VkBuffer handle() const { return device_side_.buffer; }
  /// The part of it that kernels get: its bytes, and the guard behind them, so that whoever reads on gets NaN.
  VkDescriptorBufferInfo bound() const { return {handle(), guard_, bytes_ + guard_}; }
  /// False when something was written beside its bytes. Always true without guards: see DeviceOptions.
  bool guards_hold() const;
  /// The staging twin; null where the host maps the buffer itself, and where nobody has asked for one yet.
  VkBuffer staging() const { return staging_side_.buffer; }
  /// Makes the staging twin unless there is one, or none is needed. It is no part of the buffer's value, so that a
  /// buffer which may only be read can be downloaded.
  void make_staging(Device& device) const;

 private:
  struct Allocation {
    DeviceHandle<VkBuffer, vkDestroyBuffer> buffer;
    Memory memory;
    bool is_cached = false;
  };
  /// False when no memory of the device serves that use, or too little of it is left.
  bool allocate(Device& device, MemoryUse use, Allocation& allocation) const;
  std::span<std::byte> map(Device& device, const Allocation& allocation) const;
  void place(Device& device);
  void place_between_guards(Device& device);

  std::size_t bytes_, capacity_, guard_;
  Use use_;
  std::vector<std::byte> rehearsed_;
  Allocation device_side_;
  mutable Allocation staging_side_;
  mutable std::span<std::byte> host_;  // of the whole capacity
  std::span<std::byte> guarded_;       // with the guards; empty without
};

}  // namespace alcove::gpu
