// Vulkan devices: the list, the choice, and the chosen device with its queue, its memory and its kernels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan.h>
#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/gpu/device_info.h"

namespace alcove::gpu {

/// The device is lost with everything on it; another may be made in its place.
class DeviceLost : public Error {
 public:
  using Error::Error;
};

/// Too little memory is left on the device or the host, or the driver allows no further allocation. Fewer frames at a
/// time, or smaller tiles, may fit.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// Fails with ErrorKind::device and the name of the call, unless `result` is VK_SUCCESS. A lost device throws
/// DeviceLost, and a lack of memory OutOfMemory.
void check(VkResult result, const char* call);

/// A structure of Vulkan's of this type, empty otherwise.
template <class T>
T structure(VkStructureType type) {
  T made{};
  made.sType = type;
  return made;
}

/// Whether a driver reads buffers of texels so much faster than storage buffers that kernels should: see with_texels().
bool is_fast_with_texels(VkDriverId driver, std::string_view driver_info);

class Device;
class Kernel;

/// A kernel's stem, and its specialization constants (ids 0, 1, 2 ...).
using KernelName = std::pair<std::string, std::vector<std::uint32_t>>;

/// An owner of one Vulkan handle that a device (or instance) destroys. Moves, never copies.
template <class Owner, class T, void (*destroy)(Owner, T, const VkAllocationCallbacks*)>
class Handle {
 public:
  Handle() = default;
  Handle(Owner owner, T handle) : owner_(owner), handle_(handle) {}
  Handle(Handle&& other) noexcept : owner_(other.owner_), handle_(std::exchange(other.handle_, T{})) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(owner_, other.owner_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Handle() {
    if (handle_ != T{}) destroy(owner_, handle_, nullptr);
  }
  operator T() const { return handle_; }

 private:
  Owner owner_{};
  T handle_{};
};
template <class T, void (*destroy)(VkDevice, T, const VkAllocationCallbacks*)>
using DeviceHandle = Handle<VkDevice, T, destroy>;

/// Makes an object of a device by one of Vulkan's functions, whose name is for messages. Fails as check() does.
template <class T, void (*destroy)(VkDevice, T, const VkAllocationCallbacks*), class Info>
void make(DeviceHandle<T, destroy>& to, VkDevice device,
          VkResult(VKAPI_PTR* create)(VkDevice, const Info*, const VkAllocationCallbacks*, T*), const Info& info,
          const char* name) {
  T made{};
  check(create(device, &info, nullptr, &made), name);
  to = {device, made};
}

void free_memory(Device* device, VkDeviceMemory memory, const VkAllocationCallbacks* callbacks);
/// Device memory; it counts among the allocations that the driver allows.
using Memory = Handle<Device*, VkDeviceMemory, free_memory>;

/// A logical device with one compute queue. Not movable, since everything made on it refers to it. Several threads may
/// use it, each with its own recorder.
class Device {
 public:
  /// Fails with ErrorKind::device if no device fits, naming those of the machine.
  explicit Device(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  const DeviceOptions& options() const { return options_; }
  /// The number of messages of the validation layer so far.
  int validation_messages() const { return validation_messages_; }
  double nanoseconds_per_tick() const { return nanoseconds_per_tick_; }
  bool has_timestamps() const { return timestamp_bits_ != 0; }
  std::uint64_t timestamp_mask() const { return timestamp_bits_ >= 64 ? ~0ull : (1ull << timestamp_bits_) - 1; }
  /// Whether kernels need, and the device has, a mode in which NaN, infinity and the sign of zero matter: see
  /// with_preserved_nan().
  bool preserves_nan() const { return preserves_nan_; }
  /// The longest time of a submission, in ms; infinite on a CPU, which drives no display, unless the options say
  /// otherwise.
  double submission_ms() const;

  /// The kernel of that stem, compiled on first use for these specialization constants (ids 0, 1, 2 ...). Threads that
  /// ask for a kernel in the making wait for it; others do not wait. most_bytes: of the largest buffer that it gets. If
  /// that has more words than the device takes texels, the kernel reads storage buffers.
  const Kernel& kernel(const std::string& stem, const std::vector<std::uint32_t>& specialization,
                       std::size_t most_bytes = 0);

  /// Allocates so many bytes of memory of that type; gives null if too little is left. Fails with OutOfMemory if the
  /// driver allows no further allocation, however small.
  Memory allocate(VkDeviceSize bytes, std::uint32_t type);

  VkDevice handle() const { return device_; }
  /// Hands submissions to the queue, one after the other; one fence per submission signals its end. If it fails, no
  /// submission is under way any more.
  void submit(std::span<const VkCommandBuffer> submissions, std::span<const VkFence> fences);
  /// Waits for a submission of this expected time. If a GPU finishes nothing, whoever submitted it, for as long as
  /// DeviceOptions::lost_ms says, it is lost; it may hang for ever, so nothing waits for it any more.
  void wait_for(VkFence done, double expected_ms);
  /// Whether it was lost so. Memory that it may still use must never be freed.
  bool hangs() const { return hangs_; }
  std::uint32_t queue_family() const { return queue_family_; }
  const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  /// The most storage buffers of a kernel.
  std::uint32_t most_blocks() const { return most_blocks_; }
  /// The most texels of a buffer.
  std::uint32_t most_texels() const { return most_texels_; }
  /// The bytes whose multiples are the places in a buffer that a kernel's block may begin at.
  VkDeviceSize block_alignment() const { return block_alignment_; }

 private:
  friend void free_memory(Device* device, VkDeviceMemory memory, const VkAllocationCallbacks* callbacks);
  void create_instance();
  void read_properties();
  void create_device();
  void release();

  DeviceOptions options_;
  DeviceInfo info_{};
  std::atomic<int> validation_messages_ = 0;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkPhysicalDeviceMemoryProperties memory_{};
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0, timestamp_bits_ = 0;
  double nanoseconds_per_tick_ = 1;
  bool preserves_nan_ = false;
  bool reads_texels_ = false;
  std::uint32_t most_allocations_ = 0, most_blocks_ = 0, most_texels_ = 0;
  VkDeviceSize block_alignment_ = 1;
  std::atomic<std::uint32_t> allocations_ = 0;
  std::atomic<std::uint64_t> finished_ = 0;  // submissions
  std::atomic<bool> hangs_ = false;
  std::mutex mutex_;  // of the queue and the kernels
  struct Slot {
    std::once_flag made;
    std::unique_ptr<Kernel> kernel;
  };
  std::map<std::pair<KernelName, bool>, Slot> kernels_;  // by their names, and whether they read texels
};

}  // namespace alcove::gpu
