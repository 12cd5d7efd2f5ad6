// Pipeline creation.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/kernel.h"

#include "core/base/error.h"

namespace alcove::gpu {

Kernel::Kernel(Device& device, const std::string& stem, const std::vector<std::uint32_t>& specialization)
    : stem_(stem) {
  const auto code = kernel_code(stem);
  if (code.empty()) fail(ErrorKind::device, "there is no kernel {}", stem);
  reflection_ = reflect(code);
  if (reflection_.constant_ids.size() != specialization.size() ||
      (!specialization.empty() && *reflection_.constant_ids.rbegin() != specialization.size() - 1))
    fail(ErrorKind::device, "kernel {} has specialization constants {{{}}}, and {} are given", stem,
         fmt::join(reflection_.constant_ids, ", "), specialization.size());
  create_layouts(device);
  if (device.preserves_nan())
    create_pipeline(device, with_preserved_nan(code), specialization);
  else
    create_pipeline(device, code, specialization);
}

void Kernel::create_layouts(Device& device) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const auto& block : reflection_.blocks)
    bindings.push_back({block.binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo set_info{};
  set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set_info.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set_info.bindingCount = std::uint32_t(bindings.size());
  set_info.pBindings = bindings.data();
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  check(vkCreateDescriptorSetLayout(device.handle(), &set_info, nullptr, &set_layout), "vkCreateDescriptorSetLayout");
  set_layout_ = {device.handle(), set_layout};

  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, reflection_.parameter_bytes};
  VkPipelineLayoutCreateInfo layout_info{};
  layout_info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &set_layout;
  layout_info.pushConstantRangeCount = range.size ? 1 : 0;
  layout_info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(vkCreatePipelineLayout(device.handle(), &layout_info, nullptr, &layout), "vkCreatePipelineLayout");
  layout_ = {device.handle(), layout};
}

void Kernel::create_pipeline(Device& device, std::span<const std::uint32_t> code,
                             const std::vector<std::uint32_t>& specialization) {
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = code.size_bytes();
  module_info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device.handle(), &module_info, nullptr, &module), "vkCreateShaderModule");
  const DeviceHandle<VkShaderModule, vkDestroyShaderModule> owned_module(device.handle(), module);

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t id = 0; id < specialization.size(); id++) entries.push_back({id, id * 4, 4});
  const VkSpecializationInfo constants{std::uint32_t(entries.size()), entries.data(), specialization.size() * 4,
                                       specialization.data()};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT;  // a dispatch may be cut into slices: see recorder.h
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &constants;
  info.layout = layout_;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(device.handle(), device.pipeline_cache(), 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  pipeline_ = {device.handle(), pipeline};
}

}  // namespace alcove::gpu
