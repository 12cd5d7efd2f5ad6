// Records a frame's kernels one after the other, runs them, and says what each took. It also keeps the frame's buffers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/gpu/buffer.h"
#include "core/gpu/kernel.h"

namespace alcove::gpu {

struct Binding {
  std::uint32_t slot;
  const Buffer& buffer;
};

/// Invocations in x and y; the recorder rounds up to workgroups.
struct Extent {
  Extent(std::uint32_t width, std::uint32_t height = 1) : x(width), y(height) {}
  /// As many workgroups as the three numbers at the beginning of this buffer say when the pass begins.
  explicit Extent(const Buffer& groups) : group_count(&groups) {}

  std::uint32_t x = 0, y = 0;
  const Buffer* group_count = nullptr;
};

/// What one pass took on the device, and the least it must move: each bound buffer once.
struct PassTime {
  std::string name;
  double ms = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;
};

template <class T>
concept KernelParams = std::is_trivially_copyable_v<T> && sizeof(T) <= 128;

/// One frame in flight. Use: buffer() and fill, then dispatch() ..., then run(), then read. Buffers live as long as the
/// recorder.
class Recorder {
 public:
  explicit Recorder(Device& device);

  /// The buffer of that name; made, or made again when size or use changed. Valid until the next call with another
  /// size; what was recorded before keeps its own.
  Buffer& buffer(std::string_view name, std::size_t bytes, Use use);

  /// Fills a buffer with zeros before the next dispatch.
  void clear(const Buffer& buffer);
  /// Copies what the host wrote to where kernels read it; nothing to do for mapped buffers.
  void upload(const Buffer& buffer);
  /// Copies what kernels wrote to where the host reads it after run(); nothing to do for mapped buffers.
  void download(const Buffer& buffer);

  /// Runs the kernel of that stem over the extent, after all that was recorded before. Fails unless parameters and
  /// bindings are the kernel's.
  template <KernelParams Params>
  void dispatch(const std::string& stem, const Params& params, std::initializer_list<Binding> bindings, Extent extent,
                const std::vector<std::uint32_t>& specialization = {}) {
    dispatch_bytes(stem, std::as_bytes(std::span(&params, 1)), bindings, extent, specialization);
  }

  /// Submits what was recorded and waits for it. The recorder is then empty again.
  void run();

  /// Drops what was recorded and not run: its buffers may go.
  void abandon() {
    recording_ = false;
    replaced_.clear();
  }

  /// Each pass of the last run, in order; its time is 0 on a device without timestamps.
  const std::vector<PassTime>& passes() const { return passes_; }

  /// Of all its buffers.
  std::size_t bytes() const;

 private:
  void begin();
  void barrier();
  void dispatch_bytes(const std::string& stem, std::span<const std::byte> params, std::span<const Binding> bindings,
                      Extent extent, const std::vector<std::uint32_t>& specialization);

  Device& device_;
  DeviceHandle<VkCommandPool, vkDestroyCommandPool> pool_;
  DeviceHandle<VkQueryPool, vkDestroyQueryPool> queries_;
  DeviceHandle<VkFence, vkDestroyFence> fence_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  bool recording_ = false;
  std::vector<PassTime> recorded_, passes_;
  std::map<std::string, Buffer, std::less<>> buffers_;
  std::vector<Buffer> replaced_;  // by others of their names, but used by what is recorded
};

}  // namespace alcove::gpu
