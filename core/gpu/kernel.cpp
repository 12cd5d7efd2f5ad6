// SPIR-V reflection and pipeline creation.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/kernel.h"

#include <spirv/unified1/spirv.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>

#include "core/base/error.h"

namespace alcove::gpu {
namespace {

/// The parts of a SPIR-V module that `reflect` needs, by result id.
struct Module {
  std::map<std::uint32_t, std::uint32_t> binding, set;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> member_offsets;
  std::map<std::uint32_t, std::uint32_t> array_stride, constants;
  std::map<std::uint32_t, std::vector<std::uint32_t>> types;  // opcode, then operands
  std::map<std::uint32_t, std::uint32_t> block_of;            // variable -> struct type
  std::set<std::uint32_t> not_writable, not_readable;         // struct types with such a member, and variables
  std::uint32_t push_constant_type = 0;

  /// Bytes of a type in scalar layout.
  std::uint32_t size_of(std::uint32_t type) const {
    const auto& words = types.at(type);
    switch (words[0]) {
      case spv::OpTypeInt:
      case spv::OpTypeFloat: return words[1] / 8;
      case spv::OpTypeVector: return size_of(words[1]) * words[2];
      case spv::OpTypeArray: return array_stride.at(type) * constants.at(words[2]);
      case spv::OpTypeStruct: {
        std::uint32_t size = 0;
        for (std::size_t member = 1; member < words.size(); member++)
          size = std::max(size, member_offsets.at(type).at(std::uint32_t(member - 1)) + size_of(words[member]));
        return size;
      }
      default:
        fail(ErrorKind::device, "a kernel's parameters hold a type that reflection does not know (opcode {})",
             words[0]);
    }
  }
};

void read_decoration(Module& module, Reflection& reflection, std::span<const std::uint32_t> words) {
  if (words[2] == spv::DecorationNonWritable) module.not_writable.insert(words[1]);
  if (words[2] == spv::DecorationNonReadable) module.not_readable.insert(words[1]);
  if (words.size() < 4) return;
  if (words[2] == spv::DecorationBinding) module.binding[words[1]] = words[3];
  if (words[2] == spv::DecorationDescriptorSet) module.set[words[1]] = words[3];
  if (words[2] == spv::DecorationArrayStride) module.array_stride[words[1]] = words[3];
  if (words[2] == spv::DecorationSpecId) reflection.constant_ids.insert(words[3]);
}

void read_variable(Module& module, std::span<const std::uint32_t> words) {
  if (words[3] == spv::StorageClassPushConstant) module.push_constant_type = module.types.at(words[1])[2];
  if (words[3] == spv::StorageClassStorageBuffer) module.block_of[words[2]] = module.types.at(words[1])[2];
}

void read_instruction(Module& module, Reflection& reflection, std::span<const std::uint32_t> words) {
  const auto opcode = words[0] & spv::OpCodeMask;
  switch (opcode) {
    case spv::OpDecorate: read_decoration(module, reflection, words); break;
    case spv::OpMemberDecorate:
      if (words[3] == spv::DecorationOffset) module.member_offsets[words[1]][words[2]] = words[4];
      if (words[3] == spv::DecorationNonWritable) module.not_writable.insert(words[1]);
      if (words[3] == spv::DecorationNonReadable) module.not_readable.insert(words[1]);
      break;
    case spv::OpExecutionMode:
      if (words[2] == spv::ExecutionModeLocalSize) std::copy_n(words.begin() + 3, 3, reflection.group);
      break;
    case spv::OpConstant: module.constants[words[2]] = words[3]; break;
    case spv::OpVariable: read_variable(module, words); break;
    case spv::OpTypeInt:
    case spv::OpTypeFloat:
    case spv::OpTypeVector:
    case spv::OpTypeArray:
    case spv::OpTypeStruct:
    case spv::OpTypePointer: {
      auto& type = module.types[words[1]];
      type.push_back(opcode);
      type.insert(type.end(), words.begin() + 2, words.end());
      break;
    }
    default: break;
  }
}

template <class T>
std::string join_numbers(const T& numbers) {
  return fmt::format("{{{}}}", fmt::join(numbers, ", "));
}

}  // namespace

Reflection reflect(std::span<const std::uint32_t> code) {
  constexpr std::size_t kHeaderWords = 5;
  if (code.size() < kHeaderWords || code[0] != spv::MagicNumber)
    fail(ErrorKind::device, "a kernel's code is no SPIR-V");
  Module module;
  Reflection reflection;
  for (std::size_t at = kHeaderWords; at < code.size();) {
    const std::size_t count = code[at] >> spv::WordCountShift;
    if (count == 0 || at + count > code.size()) fail(ErrorKind::device, "a kernel's SPIR-V is cut short");
    read_instruction(module, reflection, code.subspan(at, count));
    at += count;
  }
  for (const auto& [id, binding] : module.binding) {
    if (module.set[id] != 0) fail(ErrorKind::device, "a kernel binds outside descriptor set 0");
    reflection.bindings.insert(binding);
    const auto block = module.block_of[id];
    if (!module.not_readable.contains(id) && !module.not_readable.contains(block)) reflection.read.insert(binding);
    if (!module.not_writable.contains(id) && !module.not_writable.contains(block)) reflection.written.insert(binding);
  }
  if (module.push_constant_type) reflection.parameter_bytes = module.size_of(module.push_constant_type);
  return reflection;
}

Kernel::Kernel(Device& device, const std::string& stem, const std::vector<std::uint32_t>& specialization)
    : stem_(stem) {
  const auto code = kernel_code(stem);
  if (code.empty()) fail(ErrorKind::device, "there is no kernel {}", stem);
  reflection_ = reflect(code);
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t id = 0; id < specialization.size(); id++) entries.push_back({id, id * 4, 4});
  if (reflection_.constant_ids.size() != entries.size() ||
      (!entries.empty() && *reflection_.constant_ids.rbegin() != entries.size() - 1))
    fail(ErrorKind::device, "kernel {} has specialization constants {}, and {} are given", stem,
         join_numbers(reflection_.constant_ids), entries.size());

  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const auto binding : reflection_.bindings)
    bindings.push_back({binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
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

  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = code.size_bytes();
  module_info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device.handle(), &module_info, nullptr, &module), "vkCreateShaderModule");
  const DeviceHandle<VkShaderModule, vkDestroyShaderModule> owned_module(device.handle(), module);

  const VkSpecializationInfo constants{std::uint32_t(entries.size()), entries.data(), specialization.size() * 4,
                                       specialization.data()};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
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

void Kernel::require(std::size_t parameter_bytes, const std::set<std::uint32_t>& bindings) const {
  if (parameter_bytes != reflection_.parameter_bytes)
    fail(ErrorKind::device, "kernel {} takes {} bytes of parameters, and the host sends {}", stem_,
         reflection_.parameter_bytes, parameter_bytes);
  if (bindings != reflection_.bindings)
    fail(ErrorKind::device, "kernel {} has the bindings {}, and the host binds {}", stem_,
         join_numbers(reflection_.bindings), join_numbers(bindings));
}

}  // namespace alcove::gpu
