// A compute pipeline made from embedded SPIR-V, whose buffers and parameter size are read from the code itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/gpu/device.h"
#include "core/gpu/spirv.h"

namespace alcove::gpu {

/// The SPIR-V of kernels/FOLDER/STEM.comp, embedded at build time; empty when there is none of that stem.
std::span<const std::uint32_t> kernel_code(std::string_view stem);

class Kernel {
 public:
  /// Fails with ErrorKind::device when there is no such kernel, or its specialization constants are not 0 .. n-1.
  Kernel(Device& device, const std::string& stem, const std::vector<std::uint32_t>& specialization);

  const std::string& stem() const { return stem_; }
  const Reflection& reflection() const { return reflection_; }
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }

 private:
  void create_layouts(Device& device);
  void create_pipeline(Device& device, std::span<const std::uint32_t> code,
                       const std::vector<std::uint32_t>& specialization);

  std::string stem_;
  Reflection reflection_;
  DeviceHandle<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout> set_layout_;
  DeviceHandle<VkPipelineLayout, vkDestroyPipelineLayout> layout_;
  DeviceHandle<VkPipeline, vkDestroyPipeline> pipeline_;
};

}  // namespace alcove::gpu
