// What one pass of a frame took. It stands alone so that reports need not include Vulkan.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace alcove::gpu {

/// What one pass took on the device, and the least it must move: each bound buffer once.
struct PassTime {
  std::string name;
  double ms = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;
};

}  // namespace alcove::gpu
