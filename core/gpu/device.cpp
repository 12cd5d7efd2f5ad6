// Making the instance and the device, step by step; its queue, memory and cache of pipelines.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/device.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

#include "core/base/error.h"
#include "core/gpu/device_choice.h"
#include "core/gpu/kernel.h"

namespace alcove::gpu {
namespace {

/// The extension of devices that have only a part of Vulkan. Whoever uses such a device must enable it. No stable
/// header has a macro for its name.
constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* counter) {
  ++*static_cast<std::atomic<int>*>(counter);
  // No exception may pass through a driver.
  (void)std::fputs(fmt::format("vulkan validation: {}\n", data->pMessage).c_str(), stderr);
  return VK_FALSE;
}

}  // namespace

void check(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  if (result == VK_ERROR_DEVICE_LOST)
    throw DeviceLost(ErrorKind::device, fmt::format("the device was lost in {}", call));
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
    throw OutOfMemory(ErrorKind::device, fmt::format("out of memory in {}", call));
  fail(ErrorKind::device, "{} failed with Vulkan error {}", call, int(result));
}

Device::Device(const DeviceOptions& options) : options_(options) {
  try {
    create_instance();
    const PhysicalDevice chosen = choose_device(physical_devices(instance_), options_);
    physical_ = chosen.handle;
    info_ = chosen.info;
    read_properties();
    create_device();
    load_pipeline_cache();
  } catch (...) {
    release();
    throw;
  }
}

Device::~Device() { release(); }

void Device::release() {
  if (device_) {
    vkDeviceWaitIdle(device_);
    save_pipeline_cache();
    kernels_.clear();
    pipeline_cache_ = {};
    vkDestroyDevice(device_, nullptr);
  }
  if (messenger_) {
    const auto destroy =
        PFN_vkDestroyDebugUtilsMessengerEXT(vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Device::create_instance() {
  instance_ = make_instance(options_.validate);
  if (!instance_)
    fail(ErrorKind::device, "no Vulkan driver found; lavapipe computes on the CPU (Debian: mesa-vulkan-drivers)");
  if (!options_.validate) return;
  VkDebugUtilsMessengerCreateInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = on_message;
  info.pUserData = &validation_messages_;
  const auto create =
      PFN_vkCreateDebugUtilsMessengerEXT(vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  check(create(instance_, &info, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
}

void Device::read_properties() {
  const QueueFamily family = compute_family(physical_).value();  // or else the device would not have been chosen
  queue_family_ = family.index;
  timestamp_bits_ = family.timestamp_bits;
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  VkPhysicalDeviceVulkan12Properties properties12{};
  properties12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES;
  VkPhysicalDeviceProperties2 properties2{};
  properties2.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties2.pNext = &properties12;
  vkGetPhysicalDeviceProperties2(physical_, &properties2);
  const VkPhysicalDeviceProperties& properties = properties2.properties;
  // lavapipe keeps NaN and infinity in any case, as the tests of damaged frames show. Told to, it leaves out other
  // optimizations too, and its results differ in their last bits from those without.
  const bool is_lavapipe = properties12.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
  preserves_nan_ = properties12.shaderSignedZeroInfNanPreserveFloat32 == VK_TRUE && !is_lavapipe;
  nanoseconds_per_tick_ = properties.limits.timestampPeriod;
  most_allocations_ = properties.limits.maxMemoryAllocationCount;
  cache_owner_ = {properties.vendorID, properties.deviceID, std::to_array(properties.pipelineCacheUUID)};
}

void Device::create_device() {
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceVulkan12Features features12{};
  features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  features12.scalarBlockLayout = VK_TRUE;
  // Every device has robustBufferAccess: an index that came from bad input must not end in a lost device.
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &features12;
  features.features.robustBufferAccess = VK_TRUE;
  std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  if (has_extension(physical_, kPortabilitySubset)) extensions.push_back(kPortabilitySubset);
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &features;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = std::uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  push_descriptors = PFN_vkCmdPushDescriptorSetKHR(vkGetDeviceProcAddr(device_, "vkCmdPushDescriptorSetKHR"));
}

void Device::load_pipeline_cache() {
  std::string data;
  if (options_.pipeline_cache) data = read_cache(cache_file(cache_owner_), cache_owner_);
  loaded_cache_bytes_ = data.size();
  VkPipelineCacheCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  VkPipelineCache cache = VK_NULL_HANDLE;
  check(vkCreatePipelineCache(device_, &info, nullptr, &cache), "vkCreatePipelineCache");
  pipeline_cache_ = {device_, cache};
}

void Device::save_pipeline_cache() noexcept {
  if (!options_.pipeline_cache || !pipeline_cache_) return;
  try {
    std::size_t bytes = 0;
    if (vkGetPipelineCacheData(device_, pipeline_cache_, &bytes, nullptr) != VK_SUCCESS) return;
    const std::string path = cache_file(cache_owner_);
    if (path.empty() || bytes == 0 || bytes == loaded_cache_bytes_) return;
    std::vector<char> data(bytes);
    if (vkGetPipelineCacheData(device_, pipeline_cache_, &bytes, data.data()) != VK_SUCCESS) return;
    write_cache(path, std::span(data).first(bytes));
  } catch (const std::exception&) {
    // This runs in a destructor, perhaps because memory ran out. Without the cache the next start takes longer.
  }
}

double Device::submission_ms() const {
  const bool is_free = info_.type == DeviceType::cpu && options_.submission_ms == kSubmissionMs;
  return is_free ? std::numeric_limits<double>::infinity() : options_.submission_ms;
}

const Kernel& Device::kernel(const std::string& stem, const std::vector<std::uint32_t>& specialization) {
  Slot& slot = [&]() -> Slot& {
    const std::lock_guard lock(mutex_);
    return kernels_[{stem, specialization}];
  }();
  std::call_once(slot.made, [&] { slot.kernel = std::make_unique<Kernel>(*this, stem, specialization); });
  return *slot.kernel;
}

Memory Device::allocate(VkDeviceSize bytes, std::uint32_t type) {
  // Small buffers do not share allocations: a frame has some 40, and drivers allow 4096 at least, so only some hundred
  // frames at a time get here.
  if (++allocations_ > most_allocations_) {
    allocations_--;
    throw OutOfMemory(ErrorKind::device,
                      fmt::format("{} allows {} buffers in all, and the frames in flight need more; fewer --threads "
                                  "take fewer",
                                  info_.name, most_allocations_));
  }
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.allocationSize = bytes;
  info.memoryTypeIndex = type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  if (vkAllocateMemory(device_, &info, nullptr, &memory) != VK_SUCCESS) {
    allocations_--;
    return {};
  }
  return {this, memory};
}

void free_memory(Device* device, VkDeviceMemory memory, const VkAllocationCallbacks* callbacks) {
  vkFreeMemory(device->device_, memory, callbacks);
  device->allocations_--;
}

void Device::submit(std::span<const VkCommandBuffer> submissions, std::span<const VkFence> fences) {
  for (std::size_t i = 0; i < submissions.size(); i++) {
    VkSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &submissions[i];
    const std::lock_guard lock(mutex_);
    const VkResult result = vkQueueSubmit(queue_, 1, &info, fences[i]);
    // Whoever recorded them is about to reuse or free what the earlier ones still work on.
    if (result != VK_SUCCESS && i > 0) vkQueueWaitIdle(queue_);
    check(result, "vkQueueSubmit");
  }
}

}  // namespace alcove::gpu
