// A storage buffer that the host reaches directly where the device allows it, and through a staging twin where not.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/gpu/device.h"

namespace alcove::gpu {

/// Who touches a buffer: only kernels, kernels after the host wrote it, or the host after kernels wrote it.
enum class Use { device, upload, download };

class Buffer {
 public:
  /// Fails with ErrorKind::device when the device cannot bind or hold that many bytes. bytes > 0.
  Buffer(Device& device, std::size_t bytes, Use use);

  std::size_t bytes() const { return bytes_; }
  Use use() const { return use_; }
  /// The bytes as the host sees them; empty for Use::device. Stays at its place for the buffer's life.
  std::span<std::byte> host() const { return host_; }
  template <class T>
  std::span<T> as() const {
    return {reinterpret_cast<T*>(host_.data()), host_.size() / sizeof(T)};
  }

  VkBuffer handle() const { return device_side_.buffer; }
  /// The part of it that kernels get: its bytes, and the guard behind them, so that whoever reads on gets NaN.
  VkDescriptorBufferInfo bound() const { return {handle(), guard_, bytes_ + guard_}; }
  /// False when something was written beside its bytes. Always true without guards: see DeviceOptions.
  bool guards_hold() const;
  /// The staging twin; null where the host maps the buffer itself.
  VkBuffer staging() const { return staging_side_.buffer; }

 private:
  struct Allocation {
    DeviceHandle<VkBuffer, vkDestroyBuffer> buffer;
    DeviceHandle<VkDeviceMemory, vkFreeMemory> memory;
  };
  /// False when no memory type has all `wanted` properties, or none of those that have is large enough.
  bool allocate(Device& device, VkMemoryPropertyFlags wanted, Allocation& allocation) const;
  void map(Device& device, const Allocation& allocation);

  std::size_t bytes_, guard_;
  Use use_;
  Allocation device_side_, staging_side_;
  std::span<std::byte> host_, guarded_;  // guarded_: with the guards; empty without
};

}  // namespace alcove::gpu
