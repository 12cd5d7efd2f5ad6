// Vulkan instance, device choice and creation, and the pipeline cache on disk.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/device.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/gpu/kernel.h"

namespace alcove::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

struct PhysicalDevice {
  VkPhysicalDevice handle;
  DeviceInfo info;
};

std::string version_text(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::string uuid_text(const std::uint8_t (&uuid)[VK_UUID_SIZE]) {
  std::string text;
  for (int i = 0; i < int(VK_UUID_SIZE); i++)
    text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", uuid[i]);
  return text;
}

DeviceType type_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return DeviceType::cpu;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return DeviceType::integrated_gpu;
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return DeviceType::discrete_gpu;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return DeviceType::virtual_gpu;
    default: return DeviceType::other;
  }
}

/// The first queue family that computes; -1 for none.
int compute_family(VkPhysicalDevice device, std::uint32_t& timestamp_bits) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (std::uint32_t i = 0; i < count; i++)
    if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
      timestamp_bits = families[i].timestampValidBits;
      return int(i);
    }
  return -1;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data()),
        "vkEnumerateDeviceExtensionProperties");
  return std::ranges::any_of(extensions, [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

/// What a device lacks of what the kernels need; empty when nothing.
std::string missing_in(VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) return "Vulkan 1.2";
  std::uint32_t bits = 0;
  if (compute_family(device, bits) < 0) return "a compute queue";
  if (!has_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) return VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
  VkPhysicalDeviceVulkan12Features features12{};
  features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &features12;
  vkGetPhysicalDeviceFeatures2(device, &features);
  return features12.scalarBlockLayout ? "" : "scalar block layout";
}

/// What is free of the largest device-local heap; all of it where the driver does not tell.
std::uint64_t free_bytes_of(VkPhysicalDevice device) {
  VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{};
  budget.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT;
  VkPhysicalDeviceMemoryProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2;
  const bool has_budget = has_extension(device, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  if (has_budget) properties.pNext = &budget;
  vkGetPhysicalDeviceMemoryProperties2(device, &properties);

  const VkPhysicalDeviceMemoryProperties& memory = properties.memoryProperties;
  std::uint64_t largest = 0;
  std::uint64_t free = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; i++) {
    const bool is_local = memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT;
    if (!is_local || memory.memoryHeaps[i].size <= largest) continue;
    largest = memory.memoryHeaps[i].size;
    free = has_budget ? budget.heapBudget[i] - std::min(budget.heapBudget[i], budget.heapUsage[i]) : largest;
  }
  return free;
}

PhysicalDevice describe(VkPhysicalDevice device, std::uint32_t index) {
  VkPhysicalDeviceVulkan11Properties properties11{};
  properties11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES;
  VkPhysicalDeviceVulkan12Properties properties12{};
  properties12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES;
  properties12.pNext = &properties11;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &properties12;
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);

  DeviceInfo info{};
  info.index = index;
  info.name = properties.properties.deviceName;
  info.uuid = uuid_text(properties11.deviceUUID);
  info.driver = fmt::format("{} {}", properties12.driverName, properties12.driverInfo);
  info.api_version = version_text(properties.properties.apiVersion);
  info.type = type_of(properties.properties.deviceType);
  info.buffer_bytes = properties.properties.limits.maxStorageBufferRange;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; i++)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) info.memory_bytes += memory.memoryHeaps[i].size;
  if (properties.properties.apiVersion >= VK_API_VERSION_1_1) info.free_bytes = free_bytes_of(device);
  const std::string missing = missing_in(device, properties.properties);
  if (!missing.empty()) info.unusable = "it lacks " + missing;
  return {device, info};
}

std::vector<PhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  check(vkEnumeratePhysicalDevices(instance, &count, handles.data()), "vkEnumeratePhysicalDevices");
  std::vector<PhysicalDevice> devices;
  for (std::uint32_t i = 0; i < count; i++) devices.push_back(describe(handles[i], i));
  return devices;
}

/// The order in which `auto` prefers devices.
int rank_of(DeviceType type) {
  switch (type) {
    case DeviceType::discrete_gpu: return 0;
    case DeviceType::integrated_gpu: return 1;
    case DeviceType::virtual_gpu: return 2;
    case DeviceType::other: return 3;
    case DeviceType::cpu: return 4;
  }
  return 5;
}

bool is_number(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether a device is one that `choice` names.
bool is_named(const DeviceInfo& device, const std::string& choice) {
  if (choice.empty()) return false;
  if (choice == "auto") return true;
  if (choice == "cpu") return device.type == DeviceType::cpu;
  if (is_number(choice)) return std::to_string(device.index) == choice;
  return device.uuid == lower_case(choice) || lower_case(device.name).find(lower_case(choice)) != std::string::npos;
}

VkInstance make_instance(bool validate) {
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "alcove";
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  if (validate) {
    info.enabledLayerCount = info.enabledExtensionCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.ppEnabledExtensionNames = &extension;
  }
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return VK_NULL_HANDLE;  // the loader found no driver at all
  if (result == VK_ERROR_LAYER_NOT_PRESENT)
    fail(ErrorKind::device, "--validate: the layer {} is not installed (Debian: vulkan-validationlayers)",
         kValidationLayer);
  check(result, "vkCreateInstance");
  return instance;
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* counter) {
  ++*static_cast<std::atomic<int>*>(counter);
  // no exception goes through a driver
  (void)std::fputs(fmt::format("vulkan validation: {}\n", data->pMessage).c_str(), stderr);
  return VK_FALSE;
}

/// The folder for compiled pipelines after the XDG base directory specification; empty when there is no home.
std::filesystem::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
    return std::filesystem::path(cache) / "alcove";
  if (const char* home = std::getenv("HOME"); home && *home == '/')
    return std::filesystem::path(home) / ".cache" / "alcove";
  return {};
}

std::filesystem::path cache_file(const DeviceInfo& info) {
  const auto folder = cache_folder();
  return folder.empty() ? folder : folder / fmt::format("pipelines-{}.bin", info.uuid);
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

const char* name_of(DeviceType type) {
  switch (type) {
    case DeviceType::cpu: return "cpu";
    case DeviceType::integrated_gpu: return "integrated";
    case DeviceType::discrete_gpu: return "discrete";
    case DeviceType::virtual_gpu: return "virtual";
    case DeviceType::other: break;
  }
  return "other";
}

std::vector<DeviceInfo> list_devices() {
  const VkInstance instance = make_instance(false);
  if (!instance) return {};
  std::vector<DeviceInfo> infos;
  for (auto& device : physical_devices(instance)) infos.push_back(std::move(device.info));
  vkDestroyInstance(instance, nullptr);
  return infos;
}

Device::Device(const DeviceOptions& options) : options_(options) {
  try {
    create_instance();
    choose_device();
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

void Device::choose_device() {
  const auto devices = physical_devices(instance_);
  const PhysicalDevice* best = nullptr;
  std::string listed;
  for (const auto& device : devices) {
    listed += fmt::format("{}{}: {} ({}{})", listed.empty() ? "" : "; ", device.info.index, device.info.name,
                          name_of(device.info.type), device.info.unusable.empty() ? "" : ", " + device.info.unusable);
    if (!device.info.unusable.empty() || !is_named(device.info, options_.choice)) continue;
    if (!best || rank_of(device.info.type) < rank_of(best->info.type)) best = &device;
  }
  if (listed.empty())
    fail(ErrorKind::device, "no Vulkan device found; lavapipe computes on the CPU (Debian: mesa-vulkan-drivers)");
  if (!best)
    fail(ErrorKind::device, "no usable Vulkan device matches --device \"{}\"; there are {}", options_.choice, listed);
  if (options_.require_gpu && best->info.type == DeviceType::cpu)
    fail(ErrorKind::device, "--require-gpu: no GPU for --device {}; there are {}", options_.choice, listed);
  physical_ = best->handle;
  info_ = best->info;
}

void Device::create_device() {
  queue_family_ = std::uint32_t(compute_family(physical_, timestamp_bits_));
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical_, &properties);
  nanoseconds_per_tick_ = properties.limits.timestampPeriod;

  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceVulkan12Features features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  features.scalarBlockLayout = VK_TRUE;
  const char* extension = VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &features;
  info.queueCreateInfoCount = info.enabledExtensionCount = 1;
  info.pQueueCreateInfos = &queue;
  info.ppEnabledExtensionNames = &extension;
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  push_descriptors = PFN_vkCmdPushDescriptorSetKHR(vkGetDeviceProcAddr(device_, "vkCmdPushDescriptorSetKHR"));
}

void Device::load_pipeline_cache() {
  std::string bytes;
  if (options_.pipeline_cache)
    if (std::ifstream file(cache_file(info_), std::ios::binary); file)
      bytes.assign(std::istreambuf_iterator<char>(file), {});
  loaded_cache_bytes_ = bytes.size();
  VkPipelineCacheCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
  info.initialDataSize = bytes.size();  // a driver ignores what another driver or version wrote
  info.pInitialData = bytes.data();
  VkPipelineCache cache = VK_NULL_HANDLE;
  check(vkCreatePipelineCache(device_, &info, nullptr, &cache), "vkCreatePipelineCache");
  pipeline_cache_ = {device_, cache};
}

void Device::save_pipeline_cache() const {
  const auto file = cache_file(info_);
  std::size_t size = 0;
  if (!options_.pipeline_cache || file.empty() || !pipeline_cache_) return;
  if (vkGetPipelineCacheData(device_, pipeline_cache_, &size, nullptr) != VK_SUCCESS || size == 0 ||
      size == loaded_cache_bytes_)
    return;
  std::vector<char> bytes(size);
  if (vkGetPipelineCacheData(device_, pipeline_cache_, &size, bytes.data()) != VK_SUCCESS) return;
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  try {
    write_whole(file.string(), bytes);
  } catch (const Error&) {
    // A cache that cannot be written costs time, not results: read-only homes are normal on farms.
  }
}

const Kernel& Device::kernel(const std::string& stem, const std::vector<std::uint32_t>& specialization) {
  const std::lock_guard lock(mutex_);
  auto& slot = kernels_[{stem, specialization}];
  if (!slot) slot = std::make_unique<Kernel>(*this, stem, specialization);
  return *slot;
}

void Device::submit(const VkSubmitInfo& work, VkFence fence) {
  const std::lock_guard lock(mutex_);
  check(vkQueueSubmit(queue_, 1, &work, fence), "vkQueueSubmit");
}

}  // namespace alcove::gpu
