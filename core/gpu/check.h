// How Vulkan's results become errors.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vulkan/vulkan_core.h>

#include "core/base/error.h"

namespace alcove::gpu {

/// The device is gone, and all that was on it; another may be made in its place.
class DeviceLost : public Error {
 public:
  using Error::Error;
};

/// Too little memory is left, of the device or of the host, or the driver allows no further allocation. Fewer frames at
/// a time, or smaller tiles, may find room.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// Fails with ErrorKind::device, as DeviceLost or OutOfMemory where it is one of them, and with the name of the call,
/// unless `result` is VK_SUCCESS.
void check(VkResult result, const char* call);

}  // namespace alcove::gpu
