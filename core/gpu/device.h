// The Vulkan instance, the choice of a device, and its one compute queue.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace alcove::gpu {

class Kernel;

/// The device is gone, and all that was on it; another may be made in its place.
class DeviceLost : public Error {
 public:
  using Error::Error;
};

/// The device, or the host on its behalf, has no memory left; less work at once may find enough.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// Fails with ErrorKind::device (DeviceLost or OutOfMemory where it is that) and the name of the call unless `result`
/// is VK_SUCCESS.
void check(VkResult result, const char* call);

/// Owns one Vulkan handle that a device (or instance) destroys; moves, never copies.
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

enum class DeviceType { cpu, integrated_gpu, discrete_gpu, virtual_gpu, other };

/// One Vulkan device of this machine, as `alcove devices` lists it.
struct DeviceInfo {
  std::uint32_t index;
  std::string name, uuid, driver, api_version;
  DeviceType type;
  std::uint64_t memory_bytes;  // of all device-local heaps
  std::uint64_t free_bytes;    // of the largest of them, what other programs have left; all of it where none tells
  std::uint64_t buffer_bytes;  // the largest storage buffer
  std::string unusable;        // why Alcove cannot compute on it; empty: it can
};
const char* name_of(DeviceType type);

/// All devices that the loader finds; empty when there is none. Fails only when the loader itself does.
std::vector<DeviceInfo> list_devices();

struct DeviceOptions {
  std::string choice = "auto";  // auto | cpu | an index | a name or a part of it | a UUID
  bool require_gpu = false;     // a CPU device is an error
  bool validate = false;        // load the validation layer; its messages are counted and printed to stderr
  bool pipeline_cache = true;   // keep compiled pipelines in the XDG cache folder
  // false: always copy through staging buffers, as on a device whose memory the host cannot map
  bool map_memory = true;
  // for tests, a multiple of 256: before and behind every buffer; NaN, as its own bytes are until written; to write
  // there fails
  std::size_t guard_bytes = 0;
};

/// A logical device with one compute queue. Not movable: everything made on it refers to it. Several threads may use
/// it, each with its own recorder.
class Device {
 public:
  /// Fails with ErrorKind::device when no device fits, naming those that there are.
  explicit Device(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  const DeviceOptions& options() const { return options_; }
  /// Messages of the validation layer so far.
  int validation_messages() const { return validation_messages_; }
  double nanoseconds_per_tick() const { return nanoseconds_per_tick_; }
  bool has_timestamps() const { return timestamp_bits_ != 0; }
  std::uint64_t timestamp_mask() const { return timestamp_bits_ >= 64 ? ~0ull : (1ull << timestamp_bits_) - 1; }

  /// The kernel of that stem, compiled on first use for these specialization constants (ids 0, 1, 2 ...).
  const Kernel& kernel(const std::string& stem, const std::vector<std::uint32_t>& specialization);

  VkDevice handle() const { return device_; }
  /// Hands work to the queue; `fence` tells when it is done.
  void submit(const VkSubmitInfo& work, VkFence fence);
  std::uint32_t queue_family() const { return queue_family_; }
  VkPipelineCache pipeline_cache() const { return pipeline_cache_; }
  const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  PFN_vkCmdPushDescriptorSetKHR push_descriptors = nullptr;

 private:
  void create_instance();
  void choose_device();
  void create_device();
  void load_pipeline_cache();
  void save_pipeline_cache() const;
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
  DeviceHandle<VkPipelineCache, vkDestroyPipelineCache> pipeline_cache_;
  std::size_t loaded_cache_bytes_ = 0;
  std::mutex mutex_;  // of the queue and the kernels
  std::map<std::pair<std::string, std::vector<std::uint32_t>>, std::unique_ptr<Kernel>> kernels_;
};

}  // namespace alcove::gpu
