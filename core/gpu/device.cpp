// Lists and chooses devices; makes the instance and the device, step by step, with its queue, memory and kernels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/device.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/gpu/kernel.h"

namespace alcove::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

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

/// What `list` gives, a function of Vulkan's that tells the number of its entries first; nothing where it fails.
template <class T, class List>
std::vector<T> listed(const List& list) {
  std::uint32_t count = 0;
  if (list(&count, nullptr) != VK_SUCCESS) return {};
  std::vector<T> entries(count);
  return list(&count, entries.data()) == VK_SUCCESS ? entries : std::vector<T>();
}

bool is_among(const std::vector<VkExtensionProperties>& extensions, const char* name) {
  return std::ranges::any_of(extensions, [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

bool has_extension(VkPhysicalDevice device, const char* name) {
  return is_among(listed<VkExtensionProperties>([&](std::uint32_t* count, VkExtensionProperties* extensions) {
                    return vkEnumerateDeviceExtensionProperties(device, nullptr, count, extensions);
                  }),
                  name);
}

/// Whether the loader hides devices with only a portable part of Vulkan, such as MoltenVK's, unless a program asks for
/// them.
bool loader_hides_devices() {
  return is_among(listed<VkExtensionProperties>([](std::uint32_t* count, VkExtensionProperties* extensions) {
                    return vkEnumerateInstanceExtensionProperties(nullptr, count, extensions);
                  }),
                  VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
}

struct PhysicalDevice {
  VkPhysicalDevice handle;
  DeviceInfo info;
};

struct QueueFamily {
  std::uint32_t index;
  std::uint32_t timestamp_bits;  // 0: no timestamps
};

/// The first queue family that computes; nullopt if none does.
std::optional<QueueFamily> compute_family(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (std::uint32_t i = 0; i < count; i++)
    if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) return QueueFamily{i, families[i].timestampValidBits};
  return std::nullopt;
}

/// The first thing that the kernels need and a device lacks; empty if it lacks nothing.
std::string missing_in(VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) return "Vulkan 1.2";
  if (!compute_family(device)) return "a compute queue";
  auto features12 = structure<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  auto features = structure<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features12;
  vkGetPhysicalDeviceFeatures2(device, &features);
  return features12.scalarBlockLayout ? "" : "scalar block layout";
}

/// The free bytes of the largest device-local heap; all its bytes if the driver does not tell.
std::uint64_t free_bytes_of(VkPhysicalDevice device) {
  auto budget = structure<VkPhysicalDeviceMemoryBudgetPropertiesEXT>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT);
  auto properties = structure<VkPhysicalDeviceMemoryProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2);
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
  auto properties11 =
      structure<VkPhysicalDeviceVulkan11Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES);
  auto properties12 =
      structure<VkPhysicalDeviceVulkan12Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES);
  properties12.pNext = &properties11;
  auto properties = structure<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
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

bool is_number(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether `choice` names a device.
bool is_named(const DeviceInfo& device, const std::string& choice) {
  if (choice.empty()) return false;
  if (lower_case(choice) == "auto") return true;
  if (lower_case(choice) == "cpu") return device.type == DeviceType::cpu;
  if (is_number(choice)) return std::to_string(device.index) == choice;
  return device.uuid == lower_case(choice) || lower_case(device.name).find(lower_case(choice)) != std::string::npos;
}

/// The devices as text, one clause each: name, index, type, and the reason why one is useless.
std::string list_of(const std::vector<PhysicalDevice>& devices) {
  std::string list;
  for (const auto& [handle, info] : devices) {
    const std::string reason = info.unusable.empty() ? "" : ", " + info.unusable;
    list += fmt::format("{}{} (index {}, {}{})", list.empty() ? "" : "; ", info.name, info.index, name_of(info.type),
                        reason);
  }
  return list;
}

/// A Vulkan instance, with the validation layer if `validate` asks for it; null if the loader finds no driver at all.
VkInstance make_instance(bool validate) {
  auto application = structure<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "alcove";
  application.apiVersion = VK_API_VERSION_1_2;
  auto info = structure<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  std::vector<const char*> extensions;
  if (loader_hides_devices()) {
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    info.flags = VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  }
  if (validate) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  info.enabledLayerCount = validate ? 1 : 0;
  info.ppEnabledLayerNames = &kValidationLayer;
  info.enabledExtensionCount = std::uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return VK_NULL_HANDLE;
  if (result == VK_ERROR_LAYER_NOT_PRESENT)
    fail(ErrorKind::device, "--validate: the layer {} is not installed (Debian: vulkan-validationlayers)",
         kValidationLayer);
  check(result, "vkCreateInstance");
  return instance;
}

/// The devices of an instance, also those that Alcove cannot use.
std::vector<PhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  check(vkEnumeratePhysicalDevices(instance, &count, handles.data()), "vkEnumeratePhysicalDevices");
  std::vector<PhysicalDevice> devices;
  for (std::uint32_t i = 0; i < count; i++) devices.push_back(describe(handles[i], i));
  return devices;
}

/// The device that the options ask for. Fails if none fits, naming those of the machine.
PhysicalDevice choose_device(const std::vector<PhysicalDevice>& devices, const DeviceOptions& options) {
  const PhysicalDevice* best = nullptr;
  for (const auto& device : devices) {
    if (!device.info.unusable.empty() || !is_named(device.info, options.choice)) continue;
    if (!best || device.info.type < best->info.type) best = &device;
  }
  if (devices.empty())
    fail(ErrorKind::device, "no Vulkan device found; lavapipe computes on the CPU (Debian: mesa-vulkan-drivers)");
  if (!best)
    fail(ErrorKind::device, "no usable Vulkan device matches --device \"{}\"; this machine has {}", options.choice,
         list_of(devices));
  if (options.require_gpu && best->info.type == DeviceType::cpu)
    fail(ErrorKind::device, "a GPU is required, and --device {} finds none; this machine has {}", options.choice,
         list_of(devices));
  return *best;
}

}  // namespace

const char* name_of(DeviceType type) {
  constexpr const char* kNames[] = {"discrete", "integrated", "virtual", "other", "cpu"};
  return kNames[std::size_t(type)];
}

std::vector<DeviceInfo> list_devices() {
  const auto destroy = [](VkInstance instance) { vkDestroyInstance(instance, nullptr); };
  const std::unique_ptr<std::remove_pointer_t<VkInstance>, decltype(destroy)> instance(make_instance(false));
  if (!instance) return {};
  std::vector<DeviceInfo> infos;
  for (auto& device : physical_devices(instance.get())) infos.push_back(std::move(device.info));
  return infos;
}

std::string loader_version() {
  std::uint32_t version = VK_API_VERSION_1_0;  // the only version without the call
  check(vkEnumerateInstanceVersion(&version), "vkEnumerateInstanceVersion");
  return version_text(version);
}

std::vector<std::string> driver_variables() {
  return {"VK_DRIVER_FILES", "VK_ICD_FILENAMES",       "VK_INSTANCE_LAYERS",
          "LP_NUM_THREADS",  "LP_NATIVE_VECTOR_WIDTH", "CUDA_VISIBLE_DEVICES"};
}

bool is_fast_with_texels(VkDriverId driver, std::string_view driver_info) {
  constexpr std::string_view kMesa = "Mesa ";
  constexpr int kFirstWithoutLoops = 25;  // seen: 22.3 and the source of 23.2 have loops over lanes, 25.0 has none
  int version = kFirstWithoutLoops;
  if (driver_info.starts_with(kMesa))
    std::from_chars(driver_info.data() + kMesa.size(), driver_info.data() + driver_info.size(), version);
  return driver == VK_DRIVER_ID_MESA_LLVMPIPE && version < kFirstWithoutLoops;
}

namespace {

/// The extension of devices with only a part of Vulkan, which users of such a device must enable. No stable header has
/// a macro for its name.
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
  } catch (...) {
    release();
    throw;
  }
}

Device::~Device() { release(); }

void Device::release() {
  if (hangs_) {  // what waits for it, or takes away what it uses, hangs too
    new auto(std::move(kernels_));
    return;
  }
  if (device_) {
    vkDeviceWaitIdle(device_);
    kernels_.clear();
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
  auto info = structure<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
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
  auto properties12 =
      structure<VkPhysicalDeviceVulkan12Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES);
  auto properties2 = structure<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties2.pNext = &properties12;
  vkGetPhysicalDeviceProperties2(physical_, &properties2);
  const VkPhysicalDeviceProperties& properties = properties2.properties;
  // lavapipe keeps NaN and infinity in any case, as the tests of damaged frames show. In that mode it also drops other
  // optimizations, and its results differ in their last bits.
  const bool is_lavapipe = properties12.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
  preserves_nan_ = properties12.shaderSignedZeroInfNanPreserveFloat32 == VK_TRUE && !is_lavapipe;
  nanoseconds_per_tick_ = properties.limits.timestampPeriod;
  most_allocations_ = properties.limits.maxMemoryAllocationCount;
  most_blocks_ =
      std::min(properties.limits.maxPerStageDescriptorStorageBuffers, properties.limits.maxPerStageResources);
  reads_texels_ = options_.texels.value_or(is_fast_with_texels(properties12.driverID, properties12.driverInfo)) &&
                  properties.limits.maxPerStageDescriptorStorageImages >= kMostBlocks;
  most_texels_ = properties.limits.maxTexelBufferElements;
  block_alignment_ = std::max(properties.limits.minStorageBufferOffsetAlignment,
                              properties.limits.minTexelBufferOffsetAlignment);  // both are powers of 2
}

void Device::create_device() {
  const float priority = 1;
  auto queue = structure<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto features12 = structure<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  features12.scalarBlockLayout = VK_TRUE;
  // Every device has robustBufferAccess: an index that came from bad input must not end in a lost device.
  auto features = structure<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features12;
  features.features.robustBufferAccess = VK_TRUE;
  std::vector<const char*> extensions;
  if (has_extension(physical_, kPortabilitySubset)) extensions.push_back(kPortabilitySubset);
  auto info = structure<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &features;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = std::uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
}

double Device::submission_ms() const {
  const bool is_free = info_.type == DeviceType::cpu && options_.submission_ms == kSubmissionMs;
  return is_free ? std::numeric_limits<double>::infinity() : options_.submission_ms;
}

const Kernel& Device::kernel(const std::string& stem, const std::vector<std::uint32_t>& specialization,
                             std::size_t most_bytes) {
  // Mesa's compiler may round an expression otherwise where its parts are used otherwise, and the two builds of the
  // exact search, with hidden surfaces and without, then differ by a last bit. It is nearly all arithmetic.
  const bool is_arithmetic = stem == "exact";
  const bool reads_texels = reads_texels_ && !is_arithmetic && most_bytes / sizeof(float) <= most_texels_;
  Slot& slot = [&]() -> Slot& {
    const std::lock_guard lock(mutex_);
    return kernels_[{{stem, specialization}, reads_texels}];
  }();
  std::call_once(slot.made, [&] { slot.kernel = std::make_unique<Kernel>(*this, stem, specialization, reads_texels); });
  return *slot.kernel;
}

Memory Device::allocate(VkDeviceSize bytes, std::uint32_t type) {
  // Small buffers do not share allocations: a frame has some 40, and drivers allow at least 4096, so only some hundred
  // frames at a time reach that limit.
  if (++allocations_ > most_allocations_) {
    allocations_--;
    throw OutOfMemory(ErrorKind::device,
                      fmt::format("{} allows {} buffers in all, and the frames in flight need more; fewer --threads "
                                  "take fewer",
                                  info_.name, most_allocations_));
  }
  auto info = structure<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
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

void Device::wait_for(VkFence done, double expected_ms) {
  using Clock = std::chrono::steady_clock;
  constexpr std::uint64_t kLookNs = 100'000'000;
  const bool is_patient = info_.type == DeviceType::cpu;
  const std::chrono::duration<double, std::milli> most(std::max(options_.lost_ms, kPatience * expected_ms));
  std::uint64_t seen = finished_;
  VkResult result = VK_TIMEOUT;
  for (auto since = Clock::now(); result == VK_TIMEOUT;) {
    result = vkWaitForFences(device_, 1, &done, VK_TRUE, is_patient ? UINT64_MAX : kLookNs);
    if (seen != finished_) since = Clock::now();
    seen = finished_;
    if (result != VK_TIMEOUT || (!hangs_ && Clock::now() - since <= most)) continue;
    hangs_ = true;
    throw DeviceLost(ErrorKind::device, fmt::format("{} has finished nothing for {:.0f} s, and counts as lost",
                                                    info_.name, most.count() / 1000));
  }
  check(result, "vkWaitForFences");
  finished_++;
}

void Device::submit(std::span<const VkCommandBuffer> submissions, std::span<const VkFence> fences) {
  for (std::size_t i = 0; i < submissions.size(); i++) {
    auto info = structure<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    info.commandBufferCount = 1;
    info.pCommandBuffers = &submissions[i];
    const std::lock_guard lock(mutex_);
    const VkResult result = vkQueueSubmit(queue_, 1, &info, fences[i]);
    // The caller is about to reuse or free the buffers that earlier submissions still work on.
    if (result != VK_SUCCESS && i > 0) vkQueueWaitIdle(queue_);
    check(result, "vkQueueSubmit");
  }
}

}  // namespace alcove::gpu
