// Preloaded before the Vulkan loader: vkQueueSubmit loses its device, as often as ALCOVE_LOSSES says, from the third
// submission on.
// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdlib>

namespace {

std::atomic<int> submissions = 0, losses = 0;

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult vkQueueSubmit(VkQueue queue, uint32_t count,
                                                                         const VkSubmitInfo* work, VkFence fence) {
  const char* wanted = std::getenv("ALCOVE_LOSSES");
  if (wanted && ++submissions > 2 && losses < std::atoi(wanted)) {
    losses++;
    return VK_ERROR_DEVICE_LOST;
  }
  static const auto next = reinterpret_cast<PFN_vkQueueSubmit>(dlsym(RTLD_NEXT, "vkQueueSubmit"));
  return next(queue, count, work, fence);
}
