// Preloaded before the Vulkan loader: a device that lacks what ALCOVE_LACKS says, or whose allocation of the number
// ALCOVE_ALLOCATION finds no memory.
// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdlib>
#include <string_view>

namespace {

bool lacks(std::string_view what) {
  const char* lacking = std::getenv("ALCOVE_LACKS");
  return lacking && lacking == what;
}

std::atomic<int> allocations = 0;

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
  if (lacks("a known type")) properties->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_OTHER;
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
  if (!lacks("VK_KHR_push_descriptor"))
    return NEXT(vkEnumerateDeviceExtensionProperties)(device, layer, count, extensions);
  *count = 0;
  return VK_SUCCESS;
}

void vkGetPhysicalDeviceFeatures2(VkPhysicalDevice device, VkPhysicalDeviceFeatures2* features) {
  NEXT(vkGetPhysicalDeviceFeatures2)(device, features);
  if (lacks("scalar block layout"))
    static_cast<VkPhysicalDeviceVulkan12Features*>(features->pNext)->scalarBlockLayout = VK_FALSE;
}

VkResult vkCreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                        const VkAllocationCallbacks* callbacks, VkDevice* device) {
  if (lacks("a driver that works")) return VK_ERROR_INITIALIZATION_FAILED;
  return NEXT(vkCreateDevice)(physical, info, callbacks, device);
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
  if (lacks("memory") || (first && number == std::atoi(first))) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  return NEXT(vkAllocateMemory)(device, info, callbacks, memory);
}

#pragma GCC visibility pop
}
