// Records a frame's kernels one after the other, runs them, and gives the time of each. It also keeps the frame's
// buffers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/gpu/buffer.h"
#include "core/gpu/device_info.h"
#include "core/gpu/kernel.h"

namespace alcove::gpu {

/// A buffer, or null for a block that the kernel does not touch, because of its specialization or its parameters.
/// Vulkan needs a buffer all the same, so the recorder binds one of a few bytes.
struct Optional {
  explicit Optional(const Buffer* bound) : buffer(bound) {}

  const Buffer* buffer;
};

/// A buffer for a block of a kernel, by the block's name in GLSL. Fails with ErrorKind::device on null.
struct Binding {
  Binding(std::string_view name, const Buffer* bound);
  Binding(std::string_view name, Optional bound) : block(name), buffer(bound.buffer) {}
  Binding(std::string_view name, const Buffer& bound) : block(name), buffer(&bound) {}

  std::string_view block;
  const Buffer* buffer;
};

/// The number of invocations, or of workgroups, of a pass.
struct Extent {
  /// Counts invocations in x and y; the recorder rounds up to workgroups.
  Extent(std::uint32_t width, std::uint32_t height = 1) : x(width), y(height) {}
  /// Counts workgroups, by the three numbers at the beginning of this buffer when the pass begins.
  explicit Extent(const Buffer& groups) : group_count(&groups) {}
  /// Counts workgroups by a buffer that never asks for more than these. The kernel must do nothing in workgroups beyond
  /// the numbers in the buffer. Such a pass can be cut into slices when it takes too long, although only the device
  /// knows the number itself.
  Extent(const Buffer& groups, std::uint32_t most_x, std::uint32_t most_y)
      : x(most_x), y(most_y), group_count(&groups) {}

  std::uint32_t x = 0, y = 0;  // with a group_count: the most workgroups; 0: unknown
  const Buffer* group_count = nullptr;
};

/// Push constants in scalar layout, as GLSL has them: at most the 128 bytes that every Vulkan device takes.
template <class T>
concept KernelParams = std::is_trivially_copyable_v<T> && alignof(T) == 4 && sizeof(T) <= 128;

/// Records and runs one frame in flight. Use buffer() and fill buffers, then dispatch() ..., then run(), then read.
/// Buffers live as long as the recorder.
///
/// The recording goes to the device in submissions, so that none keeps it from a display for long. A pass that was not
/// measured yet is a submission of its own. Measured passes share one up to Device::submission_ms(). A pass that alone
/// would take longer is cut into slices, so kernels may not use gl_NumWorkGroups: it counts the workgroups of one
/// slice.
class Recorder {
 public:
  explicit Recorder(Device& device);
  ~Recorder();
  /// Makes a rehearsal, which needs no device and cannot run. rehearsed() gives the kernels of a frame, bytes() and
  /// largest_bytes() its buffers.
  Recorder() = default;

  /// The buffer of that name. It is made, or made again, unless the present one suits; commands that were recorded
  /// before keep the old one. The reference is valid until the next call with another size.
  Buffer& buffer(std::string_view name, std::size_t bytes, Use use = Use::device);

  /// Fills a buffer with zeros, in the order of the recording.
  void clear(const Buffer& buffer);
  /// Puts a small value at the beginning of a buffer, in the order of the recording. Use it for a buffer that gets
  /// several values in one frame: host() of a mapped buffer has only the last value when kernels run.
  template <KernelParams T>
  void write(const Buffer& buffer, const T& value) {
    static_assert(sizeof(T) % 4 == 0, "Vulkan updates whole words");
    write_bytes(buffer, std::as_bytes(std::span(&value, 1)));
  }
  /// Copies the host's bytes of a buffer that kernels wrote first to their memory. The recording copies buffers that
  /// the host writes first (Use::upload) by itself, before their first pass. Does nothing for mapped buffers.
  void upload(const Buffer& buffer);
  /// Copies the kernels' bytes to host() after run(); does nothing for mapped buffers.
  void download(const Buffer& buffer);

  /// Runs the kernel of that stem over the extent, after everything recorded before. Fails unless the parameters have
  /// the kernel's size, and the bindings name each of its blocks once and nothing else. If two kernels are made of one
  /// source, a block that one of them does not use is not among its blocks: `horizon` has no Hidden, `horizon_layers`
  /// has.
  template <KernelParams Params>
  void dispatch(const std::string& stem, const Params& params, const std::vector<Binding>& bindings, Extent extent,
                const std::vector<std::uint32_t>& specialization = {}) {
    dispatch_bytes(stem, std::as_bytes(std::span(&params, 1)), bindings, extent, specialization);
  }

  /// Submits the recording and waits for it. The recorder is then empty again. Meanwhile `watch` is called repeatedly
  /// with the share of the dispatches that are done, 0 to 1.
  void run(const std::function<void(double)>& watch = {});

  /// Drops a recording that was not run: its buffers may go.
  void abandon();

  /// The passes of the last run, in order; their times are 0 on a device without timestamps.
  const std::vector<PassTime>& passes() const { return passes_; }

  /// The kernels that a rehearsal dispatched, in order.
  const std::vector<KernelName>& rehearsed() const { return rehearsed_; }

  /// The bytes of all its buffers, with their staging twins.
  std::size_t bytes() const;
  /// The bytes of the largest buffer.
  std::size_t largest_bytes() const;

 private:
  struct PooledBuffer {
    Buffer buffer;
    std::uint64_t recording;  // the last one that asked for it
  };
  /// Commands that go to the queue at once.
  struct Submission {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    DeviceHandle<VkDescriptorPool, vkDestroyDescriptorPool> sets;  // one set per dispatch
    DeviceHandle<VkQueryPool, vkDestroyQueryPool> queries;
    DeviceHandle<VkFence, vkDestroyFence> done;
    std::vector<std::size_t> timed = {};  // the pass of every two queries
    double ms = 0;                        // expected time
  };
  struct RecordedPass {
    PassTime time;
    const Kernel* kernel;
  };

  VkCommandBuffer commands() const { return submissions_[used_ - 1].commands; }
  void begin();
  void end_submission();
  void next_submission();
  Submission make_submission();
  void make_room_for(double ms);
  void barrier();
  void wait_for(VkBuffer buffer);
  void write_bytes(const Buffer& buffer, std::span<const std::byte> value);
  void dispatch_bytes(const std::string& stem, std::span<const std::byte> params, std::span<const Binding> bindings,
                      Extent extent, const std::vector<std::uint32_t>& specialization);
  VkDescriptorSet bind(const Kernel& kernel, std::span<const Buffer* const> buffers);
  template <class Dispatch>
  void record_slice(const Kernel& kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers,
                    const Dispatch& dispatch);
  std::optional<double> measured_ms(const RecordedPass& pass) const;
  double slices_of(std::optional<double> ms, double groups, bool is_list) const;
  void wait(const std::function<void(double)>& watch) const;
  void check_guards() const;
  void read_times();
  void learn();

  Device* device_ = nullptr;  // null: this is a rehearsal
  std::vector<KernelName> rehearsed_;
  DeviceHandle<VkCommandPool, vkDestroyCommandPool> pool_;
  std::vector<Submission> submissions_;
  std::size_t used_ = 0;  // submissions that this recording has begun
  bool recording_ = false;
  bool is_short_ = false;          // memory ran out once, so no buffer may be larger than it must be
  std::uint64_t recordings_ = 0;   // run or abandoned so far
  std::vector<VkBuffer> touched_;  // since the last barrier
  std::set<VkBuffer> uploaded_;    // by the recording
  std::vector<RecordedPass> recorded_;
  std::vector<PassTime> passes_;
  std::map<const Kernel*, double> ms_per_byte_;  // the largest measured
  std::map<std::string, PooledBuffer, std::less<>> buffers_;
  // Buffers that others of the same name have replaced, but that the recording uses.
  std::vector<std::pair<std::string, Buffer>> replaced_;
};

}  // namespace alcove::gpu
