// Records a frame's kernels one after the other, runs them, and says what each took. It also keeps the frame's buffers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
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

/// The buffer for a block that the kernel declares, by the block's name in GLSL. Null: the kernel does not touch the
/// block, by its specialization or its parameters. Vulkan needs a buffer all the same, and the recorder gives it one of
/// a few bytes.
struct Binding {
  Binding(std::string_view name, const Buffer* bound) : block(name), buffer(bound) {}
  Binding(std::string_view name, const Buffer& bound) : block(name), buffer(&bound) {}

  std::string_view block;
  const Buffer* buffer;
};

/// The number of invocations, or of workgroups, of a pass.
struct Extent {
  /// Invocations in x and y; the recorder rounds up to workgroups.
  Extent(std::uint32_t width, std::uint32_t height = 1) : x(width), y(height) {}
  /// As many workgroups as the three numbers at the beginning of this buffer say when the pass begins.
  explicit Extent(const Buffer& groups) : group_count(&groups) {}
  /// The same for a buffer that never asks for more than so many workgroups, and for a kernel that does nothing in
  /// those beyond what it asks for. Such a pass can be cut into slices when it takes too long, although only the device
  /// knows the number itself.
  Extent(const Buffer& groups, std::uint32_t most_x, std::uint32_t most_y)
      : x(most_x), y(most_y), group_count(&groups) {}

  std::uint32_t x = 0, y = 0;  // with a group_count: workgroups; 0: nobody knows how many there may be
  const Buffer* group_count = nullptr;
};

/// Push constants in scalar layout, as GLSL has them: at most the 128 bytes that every Vulkan device takes.
template <class T>
concept KernelParams = std::is_trivially_copyable_v<T> && alignof(T) == 4 && sizeof(T) <= 128;

/// One frame in flight. Use: buffer() and fill, then dispatch() ..., then run(), then read. Buffers live as long as the
/// recorder.
///
/// What is recorded goes to the device in submissions, so that none keeps it from a display for long: a pass that has
/// not been measured yet is a submission of its own, passes that have been share one up to Device::submission_ms(), and
/// a pass that alone would take longer is cut into slices. So kernels may not use gl_NumWorkGroups: it counts the
/// workgroups of one slice.
class Recorder {
 public:
  explicit Recorder(Device& device);
  /// A rehearsal, which needs no device and cannot run. rehearsed() tells the kernels that a frame takes, and bytes()
  /// and largest_bytes() the buffers.
  Recorder() = default;

  /// The buffer of that name. It is made, or made again, unless the one that there is suits; what was recorded before
  /// keeps the one that it had. The reference is valid until the next call with another size.
  Buffer& buffer(std::string_view name, std::size_t bytes, Use use = Use::device);

  /// Fills a buffer with zeros, in the order of what is recorded.
  void clear(const Buffer& buffer);
  /// Puts a small value at the beginning of a buffer, in the order of what is recorded. A buffer that gets several
  /// values in one frame must get them so: host() of a mapped one has only the last by the time that kernels run.
  template <KernelParams T>
  void write(const Buffer& buffer, const T& value) {
    static_assert(sizeof(T) % 4 == 0, "Vulkan updates whole words");
    write_bytes(buffer, std::as_bytes(std::span(&value, 1)));
  }
  /// Copies what the host wrote to where kernels read it; nothing to do for mapped buffers.
  void upload(const Buffer& buffer);
  /// Copies what kernels wrote to where host() shows it after run(); nothing to do for mapped buffers.
  void download(const Buffer& buffer);

  /// Runs the kernel of that stem over the extent, after all that was recorded before. Fails unless the parameters have
  /// the kernel's size, and the bindings name each of its blocks once and nothing else. A block that one of two kernels
  /// of the same source does not use is none of its blocks: `horizon` has no Hidden, `horizon_layers` has.
  template <KernelParams Params>
  void dispatch(const std::string& stem, const Params& params, const std::vector<Binding>& bindings, Extent extent,
                const std::vector<std::uint32_t>& specialization = {}) {
    dispatch_bytes(stem, std::as_bytes(std::span(&params, 1)), bindings, extent, specialization);
  }

  /// Submits what was recorded and waits for it. The recorder is then empty again. `watch` is told meanwhile, ever
  /// again, which share of the dispatches is done, 0 to 1.
  void run(const std::function<void(double)>& watch = {});

  /// Drops what was recorded and not run: its buffers may go.
  void abandon();

  /// Each pass of the last run, in order; its time is 0 on a device without timestamps.
  const std::vector<PassTime>& passes() const { return passes_; }

  /// The kernels that were dispatched in a rehearsal, in order.
  const std::vector<KernelName>& rehearsed() const { return rehearsed_; }

  /// Of all its buffers, their staging twins included.
  std::size_t bytes() const;
  /// Of the largest buffer.
  std::size_t largest_bytes() const;

 private:
  struct PooledBuffer {
    Buffer buffer;
    std::uint64_t recording;  // in which it was last asked for
  };
  /// What the queue gets at once.
  struct Submission {
    VkCommandBuffer commands;
    DeviceHandle<VkQueryPool, vkDestroyQueryPool> queries;
    DeviceHandle<VkFence, vkDestroyFence> done;
    std::vector<std::size_t> timed = {};  // the pass that every two queries are of
    double ms = 0;                        // that it is expected to take
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
  bool is_short_ = false;          // of memory: it ran out once, so from then on no buffer is larger than it must be
  std::uint64_t recordings_ = 0;   // that were run or abandoned
  std::vector<VkBuffer> touched_;  // since the last barrier
  std::vector<RecordedPass> recorded_;
  std::vector<PassTime> passes_;
  std::map<const Kernel*, double> ms_per_byte_;  // the most that was measured
  std::map<std::string, PooledBuffer, std::less<>> buffers_;
  // Replaced by others of the same names, but used by what is recorded.
  std::vector<std::pair<std::string, Buffer>> replaced_;
};

}  // namespace alcove::gpu
