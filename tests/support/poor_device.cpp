// Preloaded before the Vulkan loader: a poor device.
// SPDX-License-Identifier: BSD-3-Clause
//
// It lacks what ALCOVE_LACKS says; without right values, the last rows of workgroups are not computed. Its allocation
// of the number ALCOVE_ALLOCATION finds no memory, and neither do its first ALCOVE_FIRST. Its first ALCOVE_TOGETHER
// allocations wait until each of so many threads has asked for one, and find none together.
// With ALCOVE_HEAP it is a discrete GPU with so many bytes of its own memory, which the host cannot map;
// ALCOVE_HEAP_SAYS is what it says to have where that is another number, and ALCOVE_HEAP_USED is what it says that
// other programs have taken.
#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>

namespace {

bool lacks(std::string_view what) {
  const char* lacking = std::getenv("ALCOVE_LACKS");
  return lacking && lacking == what;
}

std::atomic<int> allocations = 0;
std::atomic<int> devices = 0;

/// The number that a variable of the environment holds; 0 for none.
VkDeviceSize number_in(const char* variable) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : 0;
}

// Of the device with a heap of its own: memory types of the same numbers as their heaps.
constexpr uint32_t kOwnMemory = 0;
constexpr uint32_t kHostMemory = 1;

VkDeviceSize stated_heap() {
  return number_in("ALCOVE_HEAP_SAYS") ? number_in("ALCOVE_HEAP_SAYS") : number_in("ALCOVE_HEAP");
}

void split_heap(VkPhysicalDeviceMemoryProperties& memory) {
  const VkDeviceSize host_bytes = memory.memoryHeaps[0].size;
  memory.memoryHeapCount = memory.memoryTypeCount = 2;
  memory.memoryHeaps[kOwnMemory] = {stated_heap(), VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
  memory.memoryHeaps[kHostMemory] = {host_bytes, 0};
  memory.memoryTypes[kOwnMemory] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, kOwnMemory};
  memory.memoryTypes[kHostMemory] = {
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
      kHostMemory};
}

/// What is allocated of the device's own memory, by whom.
class Heap {
 public:
  bool take(VkDeviceSize bytes) {
    const std::lock_guard lock(mutex_);
    if (taken_ + bytes > number_in("ALCOVE_HEAP")) return false;
    taken_ += bytes;
    return true;
  }
  void name(VkDeviceMemory memory, VkDeviceSize bytes) {
    const std::lock_guard lock(mutex_);
    owners_[memory] = bytes;
  }
  void give_back(VkDeviceMemory memory) {
    const std::lock_guard lock(mutex_);
    const auto owner = owners_.find(memory);
    if (owner == owners_.end()) return;
    taken_ -= owner->second;
    owners_.erase(owner);
  }

 private:
  std::mutex mutex_;
  VkDeviceSize taken_ = 0;
  std::map<VkDeviceMemory, VkDeviceSize> owners_;
};
Heap heap;

}  // namespace

/// The loader's own function of the same name.
#define NEXT(name) reinterpret_cast<PFN_##name>(dlsym(RTLD_NEXT, #name))

extern "C" {
#pragma GCC visibility push(default)

VkResult vkEnumeratePhysicalDevices(VkInstance instance, uint32_t* count, VkPhysicalDevice* devices) {
  if (!lacks("any device")) return NEXT(vkEnumeratePhysicalDevices)(instance, count, devices);
  *count = 0;
  return VK_SUCCESS;
}

void vkGetPhysicalDeviceProperties2(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties) {
  NEXT(vkGetPhysicalDeviceProperties2)(device, properties);
  if (lacks("Vulkan 1.2")) properties->properties.apiVersion = VK_API_VERSION_1_1;
  if (lacks("buffers")) properties->properties.limits.maxPerStageDescriptorStorageBuffers = 2;
  if (lacks("a known type")) properties->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  if (number_in("ALCOVE_HEAP")) properties->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
}

void vkGetPhysicalDeviceMemoryProperties(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties* memory) {
  NEXT(vkGetPhysicalDeviceMemoryProperties)(device, memory);
  if (number_in("ALCOVE_HEAP")) split_heap(*memory);
}

void vkGetPhysicalDeviceMemoryProperties2(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties2* memory) {
  NEXT(vkGetPhysicalDeviceMemoryProperties2)(device, memory);
  if (!number_in("ALCOVE_HEAP")) return;
  split_heap(memory->memoryProperties);
  if (!memory->pNext) return;
  auto& budget = *static_cast<VkPhysicalDeviceMemoryBudgetPropertiesEXT*>(memory->pNext);
  budget.heapBudget[kOwnMemory] = stated_heap();
  budget.heapUsage[kOwnMemory] = number_in("ALCOVE_HEAP_USED");
}

void vkGetBufferMemoryRequirements(VkDevice device, VkBuffer buffer, VkMemoryRequirements* needs) {
  NEXT(vkGetBufferMemoryRequirements)(device, buffer, needs);
  if (number_in("ALCOVE_HEAP")) needs->memoryTypeBits = 1u << kOwnMemory | 1u << kHostMemory;
}

void vkGetPhysicalDeviceQueueFamilyProperties(VkPhysicalDevice device, uint32_t* count,
                                              VkQueueFamilyProperties* families) {
  NEXT(vkGetPhysicalDeviceQueueFamilyProperties)(device, count, families);
  for (uint32_t i = 0; families && i < *count; i++) {
    if (lacks("a compute queue")) families[i].queueFlags &= ~VkQueueFlags(VK_QUEUE_COMPUTE_BIT);
    if (lacks("timestamps")) families[i].timestampValidBits = 0;
  }
}

VkResult vkEnumerateDeviceExtensionProperties(VkPhysicalDevice device, const char* layer, uint32_t* count,
                                              VkExtensionProperties* extensions) {
  const uint32_t room = *count;
  const VkResult result = NEXT(vkEnumerateDeviceExtensionProperties)(device, layer, count, extensions);
  if (!number_in("ALCOVE_HEAP_USED") || result != VK_SUCCESS) return result;
  if (extensions && *count < room) std::strcpy(extensions[*count].extensionName, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  ++*count;
  return result;
}

void vkGetPhysicalDeviceFeatures2(VkPhysicalDevice device, VkPhysicalDeviceFeatures2* features) {
  NEXT(vkGetPhysicalDeviceFeatures2)(device, features);
  if (lacks("scalar block layout"))
    static_cast<VkPhysicalDeviceVulkan12Features*>(features->pNext)->scalarBlockLayout = VK_FALSE;
}

VkResult vkCreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                        const VkAllocationCallbacks* callbacks, VkDevice* device) {
  if (lacks("a driver that works")) return VK_ERROR_INITIALIZATION_FAILED;
  if (lacks("memory for a second device") && ++devices > 1) return VK_ERROR_OUT_OF_HOST_MEMORY;
  return NEXT(vkCreateDevice)(physical, info, callbacks, device);
}

void vkCmdDispatchBase(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z, uint32_t columns, uint32_t rows,
                       uint32_t layers) {
  if (lacks("right values") && rows > 1) rows--;
  NEXT(vkCmdDispatchBase)(commands, x, y, z, columns, rows, layers);
}

VkResult vkCreateComputePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                  const VkComputePipelineCreateInfo* infos, const VkAllocationCallbacks* callbacks,
                                  VkPipeline* pipelines) {
  if (lacks("memory for kernels")) return VK_ERROR_OUT_OF_HOST_MEMORY;
  return NEXT(vkCreateComputePipelines)(device, cache, count, infos, callbacks, pipelines);
}

VkResult vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* callbacks,
                          VkDeviceMemory* memory) {
  const char* first = std::getenv("ALCOVE_ALLOCATION");
  const int number = ++allocations;
  if (const auto together = int(number_in("ALCOVE_TOGETHER")); number <= together) {
    while (allocations < together) std::this_thread::yield();
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  }
  const bool is_of_first = number <= int(number_in("ALCOVE_FIRST"));
  if (lacks("memory") || is_of_first || (first && number == std::atoi(first))) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  if (!number_in("ALCOVE_HEAP")) return NEXT(vkAllocateMemory)(device, info, callbacks, memory);
  const bool is_own = info->memoryTypeIndex == kOwnMemory;
  if (is_own && !heap.take(info->allocationSize)) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  VkMemoryAllocateInfo of_the_driver = *info;
  of_the_driver.memoryTypeIndex = 0;
  const VkResult result = NEXT(vkAllocateMemory)(device, &of_the_driver, callbacks, memory);
  if (is_own) heap.name(*memory, info->allocationSize);
  return result;
}

void vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks* callbacks) {
  heap.give_back(memory);
  NEXT(vkFreeMemory)(device, memory, callbacks);
}

#pragma GCC visibility pop
}
