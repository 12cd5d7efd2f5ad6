// The functions of Vulkan that are told or shown something else.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/driver/fake_driver.h"

#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>

namespace alcove::test {
namespace {

constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";

/// A discrete GPU's types: its own memory; a window to it that the host sees and does not cache; the host's memory.
constexpr VkMemoryPropertyFlags kOwnMemory[] = {
    VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
    VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
constexpr std::uint32_t kOwnTypes = 3;

std::mutex mutex;
std::map<VkDeviceMemory, std::uint32_t> type_of_memory;

}  // namespace

FakeDriver& fake_driver() {
  static FakeDriver fake{.has_own_memory = std::getenv("ALCOVE_FAKE_MEMORY") != nullptr};
  return fake;
}

namespace {

FakeDriver& fake() { return fake_driver(); }

}  // namespace
}  // namespace alcove::test

/// The loader's own function of the same name.
#define NEXT(name) reinterpret_cast<PFN_##name>(dlsym(RTLD_NEXT, #name))

using namespace alcove::test;

extern "C" {
#pragma GCC visibility push(default)

VkResult vkCreateInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                          VkInstance* instance) {
  fake().instance_flags = info->flags;
  fake().instance_extensions.assign(info->ppEnabledExtensionNames,
                                    info->ppEnabledExtensionNames + info->enabledExtensionCount);
  const VkResult result = NEXT(vkCreateInstance)(info, callbacks, instance);
  fake().live_instances += result == VK_SUCCESS;
  return result;
}

void vkDestroyInstance(VkInstance instance, const VkAllocationCallbacks* callbacks) {
  fake().live_instances--;
  NEXT(vkDestroyInstance)(instance, callbacks);
}

VkResult vkEnumerateDeviceExtensionProperties(VkPhysicalDevice device, const char* layer, uint32_t* count,
                                              VkExtensionProperties* extensions) {
  if (fake().lists_no_extensions) return VK_ERROR_OUT_OF_HOST_MEMORY;
  const uint32_t room = *count;
  const VkResult result = NEXT(vkEnumerateDeviceExtensionProperties)(device, layer, count, extensions);
  if (!fake().is_portable || result != VK_SUCCESS) return result;
  if (extensions && *count < room) std::strcpy(extensions[*count].extensionName, kPortabilitySubset);
  ++*count;
  return result;
}

void vkGetPhysicalDeviceProperties2(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties) {
  NEXT(vkGetPhysicalDeviceProperties2)(device, properties);
  if (fake().is_discrete) properties->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  for (auto* next = static_cast<VkBaseOutStructure*>(properties->pNext); next; next = next->pNext) {
    if (next->sType != VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES) continue;
    auto& properties12 = *reinterpret_cast<VkPhysicalDeviceVulkan12Properties*>(next);
    if (fake().is_discrete) properties12.driverID = VK_DRIVER_ID_NVIDIA_PROPRIETARY;
    if (!fake().version.empty()) *std::ranges::copy(fake().version, properties12.driverInfo).out = 0;
  }
  if (fake().most_texels) properties->properties.limits.maxTexelBufferElements = fake().most_texels;
  if (fake().most_allocations) properties->properties.limits.maxMemoryAllocationCount = fake().most_allocations;
}

void vkGetPhysicalDeviceMemoryProperties(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties* memory) {
  NEXT(vkGetPhysicalDeviceMemoryProperties)(device, memory);
  if (!fake().has_own_memory) return;
  memory->memoryTypeCount = kOwnTypes;
  for (uint32_t type = 0; type < kOwnTypes; type++) memory->memoryTypes[type] = {kOwnMemory[type], 0};
}

void vkGetBufferMemoryRequirements(VkDevice device, VkBuffer buffer, VkMemoryRequirements* needs) {
  NEXT(vkGetBufferMemoryRequirements)(device, buffer, needs);
  if (fake().has_own_memory) needs->memoryTypeBits = (1u << kOwnTypes) - 1;
}

VkResult vkCreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                        const VkAllocationCallbacks* callbacks, VkDevice* device) {
  fake().device_extensions.assign(info->ppEnabledExtensionNames,
                                  info->ppEnabledExtensionNames + info->enabledExtensionCount);
  const auto* features = static_cast<const VkPhysicalDeviceFeatures2*>(info->pNext);
  fake().is_robust =
      features->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2 && features->features.robustBufferAccess;
  std::vector<const char*> known;
  for (const auto& name : fake().device_extensions)
    if (name != kPortabilitySubset) known.push_back(name.c_str());
  VkDeviceCreateInfo real = *info;
  real.enabledExtensionCount = uint32_t(known.size());
  real.ppEnabledExtensionNames = known.data();
  return NEXT(vkCreateDevice)(physical, &real, callbacks, device);
}

VkResult vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* callbacks,
                          VkDeviceMemory* memory) {
  const std::lock_guard lock(mutex);
  VkMemoryAllocateInfo real = *info;
  if (fake().has_own_memory) real.memoryTypeIndex = 0;
  const VkResult result = NEXT(vkAllocateMemory)(device, &real, callbacks, memory);
  if (result != VK_SUCCESS) return result;
  fake().allocations++;
  fake().live_allocations++;
  type_of_memory[*memory] = info->memoryTypeIndex;
  return result;
}

void vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks* callbacks) {
  const std::lock_guard lock(mutex);
  fake().live_allocations--;
  NEXT(vkFreeMemory)(device, memory, callbacks);
}

VkResult vkMapMemory(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
                     VkMemoryMapFlags flags, void** data) {
  const std::lock_guard lock(mutex);
  fake().mapped_types.push_back(type_of_memory[memory]);
  return NEXT(vkMapMemory)(device, memory, offset, size, flags, data);
}

VkResult vkCreateShaderModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                              const VkAllocationCallbacks* callbacks, VkShaderModule* module) {
  const std::lock_guard lock(mutex);  // kernels are made on several threads
  fake().modules.emplace_back(info->pCode, info->pCode + info->codeSize / 4);
  return NEXT(vkCreateShaderModule)(device, info, callbacks, module);
}

VkResult vkWaitForFences(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all, uint64_t nanoseconds) {
  if (!fake().hangs) return NEXT(vkWaitForFences)(device, count, fences, all, nanoseconds);
  NEXT(vkWaitForFences)(device, count, fences, all, std::numeric_limits<uint64_t>::max());  // lavapipe's do not hang
  return nanoseconds == std::numeric_limits<uint64_t>::max() ? VK_SUCCESS : VK_TIMEOUT;
}

VkResult vkDeviceWaitIdle(VkDevice device) {
  fake().idle_waits++;
  return NEXT(vkDeviceWaitIdle)(device);
}

VkResult vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo* work, VkFence fence) {
  fake().submissions++;
  if (fake().failing_submission && --fake().failing_submission == 0) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  return NEXT(vkQueueSubmit)(queue, count, work, fence);
}

void vkCmdDispatchBase(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z, uint32_t count_x, uint32_t count_y,
                       uint32_t count_z) {
  fake().slices += x + y > 0;
  NEXT(vkCmdDispatchBase)(commands, x, y, z, count_x, count_y, count_z);
}

VkResult vkGetQueryPoolResults(VkDevice device, VkQueryPool pool, uint32_t first, uint32_t count, size_t bytes,
                               void* data, VkDeviceSize stride, VkQueryResultFlags flags) {
  const VkResult result = NEXT(vkGetQueryPoolResults)(device, pool, first, count, bytes, data, stride, flags);
  auto* ticks = static_cast<std::uint64_t*>(data);
  const std::uint64_t taken = fake().queries++ % 3 == 0 ? fake().slow_ticks : 1;
  for (uint32_t i = 1; i < count && fake().slow_ticks; i += 2) ticks[i] = ticks[i - 1] + taken;
  return result;
}

#pragma GCC visibility pop
}
