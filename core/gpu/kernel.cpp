// Reads and edits SPIR-V, and creates pipelines from it. Numbers and layout: the SPIR-V specification, section 2.3.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/kernel.h"

#include <spirv/unified1/spirv.hpp>

#include <algorithm>
#include <set>
#include <string_view>

#include "core/base/error.h"

namespace alcove::gpu {

namespace {

/// The index of a module's first instruction.
std::size_t first_instruction(std::span<const std::uint32_t> code) {
  constexpr std::size_t kHeaderWords = 5;
  if (code.size() < kHeaderWords || code[0] != spv::MagicNumber)
    fail(ErrorKind::device, "a kernel's code is no SPIR-V");
  return kHeaderWords;
}

/// The length of an instruction in words.
std::size_t words_at(std::span<const std::uint32_t> code, std::size_t at) {
  const std::size_t count = code[at] >> spv::WordCountShift;
  if (count == 0 || at + count > code.size()) fail(ErrorKind::device, "a kernel's SPIR-V is cut short");
  return count;
}

/// The parts of a SPIR-V module that `reflect` needs, by result id.
struct Module {
  std::map<std::uint32_t, std::string> names;
  std::map<std::uint32_t, std::uint32_t> binding, set, constant_id;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> member_offsets;
  std::map<std::uint32_t, std::uint32_t> array_stride, constants;
  std::map<std::uint32_t, std::vector<std::uint32_t>> types;  // opcode, then operands
  std::map<std::uint32_t, std::uint32_t> block_of;            // variable -> struct type
  std::map<std::uint32_t, std::uint32_t> place_in;            // pointer into a variable -> that
  std::set<std::uint32_t> not_writable, not_readable;         // struct types with such a member, and variables
  std::set<std::uint32_t> with_atomics, read_in_parts;        // variables; of the latter, components of elements
  std::uint32_t push_constant_type = 0;

  /// The bytes of a type in scalar layout.
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

  /// See Block::texel.
  VkFormat texel_of(std::uint32_t variable) const {
    const auto& members = types.at(block_of.at(variable));
    if (members.size() != 2 || types.at(members[1])[0] != spv::OpTypeRuntimeArray) return VK_FORMAT_UNDEFINED;
    const auto& element = types.at(types.at(members[1])[1]);
    if (element[0] == spv::OpTypeFloat) return VK_FORMAT_R32_SFLOAT;
    const bool is_four = element[0] == spv::OpTypeVector && element[2] == 4;
    if (is_four && types.at(element[1])[0] == spv::OpTypeFloat && !read_in_parts.contains(variable))
      return VK_FORMAT_R32G32B32A32_SFLOAT;
    return element[0] == spv::OpTypeInt && element[2] == 0 ? VK_FORMAT_R32_UINT : VK_FORMAT_UNDEFINED;
  }
};

void read_decoration(Module& module, std::span<const std::uint32_t> words) {
  if (words[2] == spv::DecorationNonWritable) module.not_writable.insert(words[1]);
  if (words[2] == spv::DecorationNonReadable) module.not_readable.insert(words[1]);
  if (words.size() < 4) return;
  if (words[2] == spv::DecorationBinding) module.binding[words[1]] = words[3];
  if (words[2] == spv::DecorationDescriptorSet) module.set[words[1]] = words[3];
  if (words[2] == spv::DecorationArrayStride) module.array_stride[words[1]] = words[3];
  if (words[2] == spv::DecorationSpecId) module.constant_id[words[1]] = words[3];
}

std::string name_of(std::span<const std::uint32_t> words) {
  const std::string_view text(reinterpret_cast<const char*>(words.data() + 2), 4 * (words.size() - 2));
  return std::string(text.substr(0, text.find('\0')));
}

void read_variable(Module& module, std::span<const std::uint32_t> words) {
  if (words[3] == spv::StorageClassPushConstant) module.push_constant_type = module.types.at(words[1])[2];
  if (words[3] == spv::StorageClassStorageBuffer) module.block_of[words[2]] = module.types.at(words[1])[2];
}

bool is_atomic(std::uint32_t opcode) { return opcode >= spv::OpAtomicLoad && opcode <= spv::OpAtomicXor; }

void read_instruction(Module& module, Reflection& reflection, std::span<const std::uint32_t> words) {
  const auto opcode = words[0] & spv::OpCodeMask;
  switch (opcode) {
    case spv::OpName: module.names[words[1]] = name_of(words); break;
    case spv::OpDecorate: read_decoration(module, words); break;
    case spv::OpMemberDecorate:
      if (words[3] == spv::DecorationOffset) module.member_offsets[words[1]][words[2]] = words[4];
      if (words[3] == spv::DecorationNonWritable) module.not_writable.insert(words[1]);
      if (words[3] == spv::DecorationNonReadable) module.not_readable.insert(words[1]);
      break;
    case spv::OpExecutionMode:
      if (words[2] == spv::ExecutionModeLocalSize) std::copy_n(words.begin() + 3, 3, reflection.group);
      break;
    case spv::OpConstant: module.constants[words[2]] = words[3]; break;
    case spv::OpSpecConstant: reflection.constants[module.constant_id.at(words[2])] = words[3]; break;
    case spv::OpVariable: read_variable(module, words); break;
    case spv::OpAccessChain: {
      constexpr std::size_t kWordsToAnElement = 6;  // behind the index of the block's only member
      module.place_in[words[2]] = words[3];
      if (words.size() > kWordsToAnElement) module.read_in_parts.insert(words[3]);
      break;
    }
    case spv::OpTypeInt:
    case spv::OpTypeFloat:
    case spv::OpTypeVector:
    case spv::OpTypeArray:
    case spv::OpTypeRuntimeArray:
    case spv::OpTypeStruct:
    case spv::OpTypePointer: {
      auto& type = module.types[words[1]];
      type.push_back(opcode);
      type.insert(type.end(), words.begin() + 2, words.end());
      break;
    }
    default:
      if (is_atomic(opcode)) module.with_atomics.insert(module.place_in[words[opcode == spv::OpAtomicStore ? 1 : 3]]);
  }
}

/// The first word of an instruction.
std::uint32_t opening(spv::Op opcode, std::uint32_t words) {
  return words << spv::WordCountShift | std::uint32_t(opcode);
}

}  // namespace

Reflection reflect(std::span<const std::uint32_t> code) {
  Module module;
  Reflection reflection;
  for (std::size_t at = first_instruction(code); at < code.size(); at += words_at(code, at))
    read_instruction(module, reflection, code.subspan(at, words_at(code, at)));
  for (const auto& [id, binding] : module.binding) {
    if (module.set[id] != 0) fail(ErrorKind::device, "a kernel binds outside descriptor set 0");
    const auto type = module.block_of[id];
    const bool is_read = !module.not_readable.contains(id) && !module.not_readable.contains(type);
    const bool is_written = !module.not_writable.contains(id) && !module.not_writable.contains(type);
    const bool may_be_texels = is_read && !module.with_atomics.contains(id);
    reflection.blocks.push_back(
        {module.names[type], binding, is_read, is_written, may_be_texels ? module.texel_of(id) : VK_FORMAT_UNDEFINED});
  }
  if (module.push_constant_type) reflection.parameter_bytes = module.size_of(module.push_constant_type);
  return reflection;
}

std::vector<std::uint32_t> with_preserved_nan(std::span<const std::uint32_t> code) {
  const std::uint32_t capability[] = {opening(spv::OpCapability, 2), spv::CapabilitySignedZeroInfNanPreserve};
  std::vector<std::uint32_t> result(code.begin(), code.end());
  // Capabilities come first in a module, and execution modes directly behind the entry points.
  std::size_t at = first_instruction(code);
  result.insert(result.begin() + std::ptrdiff_t(at), std::begin(capability), std::end(capability));
  for (at += std::size(capability); at < result.size(); at += words_at(result, at)) {
    if ((result[at] & spv::OpCodeMask) != spv::OpEntryPoint) continue;
    const std::uint32_t float_bits = 32;
    const std::uint32_t mode[] = {opening(spv::OpExecutionMode, 4), result[at + 2],
                                  spv::ExecutionModeSignedZeroInfNanPreserve, float_bits};
    const std::size_t behind = at + words_at(result, at);
    result.insert(result.begin() + std::ptrdiff_t(behind), std::begin(mode), std::end(mode));
    return result;
  }
  fail(ErrorKind::device, "a kernel's SPIR-V has no entry point");
}

namespace {

/// The ids of types by which a kernel reads texels of one format.
struct TexelTypes {
  std::uint32_t scalar = 0, vector = 0, image = 0, pointer = 0;
};

std::uint32_t image_format_of(VkFormat format) {
  if (format == VK_FORMAT_R32G32B32A32_SFLOAT) return spv::ImageFormatRgba32f;
  return format == VK_FORMAT_R32_UINT ? spv::ImageFormatR32ui : spv::ImageFormatR32f;
}

/// Writes a module anew, instruction by instruction, and changes those that have to do with buffers of texels.
class TexelWriter {
 public:
  TexelWriter(std::span<const std::uint32_t> code, std::span<const Block> blocks) : code_(code), bound_(code[3]) {
    for (std::size_t at = first_instruction(code); at < code.size(); at += words_at(code, at))
      look_at(code.subspan(at, words_at(code, at)), blocks);
  }

  std::vector<std::uint32_t> written() {
    const std::size_t first = first_instruction(code_);
    result_.assign(code_.begin(), code_.begin() + std::ptrdiff_t(first));
    write(spv::OpCapability, {spv::CapabilityImageBuffer});
    for (std::size_t at = first; at < code_.size(); at += words_at(code_, at))
      rewrite(code_.subspan(at, words_at(code_, at)));
    result_[3] = bound_;
    return std::move(result_);
  }

 private:
  struct Place {
    std::uint32_t variable, index;  // ids
  };

  /// Notes the ids of the variables, and those of the types that exist: none may be declared twice.
  void look_at(std::span<const std::uint32_t> words, std::span<const Block> blocks) {
    const auto opcode = words[0] & spv::OpCodeMask;
    if (opcode == spv::OpDecorate && words[2] == spv::DecorationBinding) {
      const auto block = std::ranges::find(blocks, words[3], &Block::binding);
      if (block != blocks.end() && block->texel != VK_FORMAT_UNDEFINED) format_of_[words[1]] = block->texel;
    }
    if (opcode == spv::OpTypeFloat)
      types_[VK_FORMAT_R32_SFLOAT].scalar = types_[VK_FORMAT_R32G32B32A32_SFLOAT].scalar = words[1];
    if (opcode == spv::OpTypeInt && words[3] == 0) types_[VK_FORMAT_R32_UINT].scalar = words[1];
    if (opcode == spv::OpTypeVector && words[3] == 4)
      for (auto& [format, types] : types_)
        if (types.scalar == words[2]) types.vector = words[1];
  }

  void rewrite(std::span<const std::uint32_t> words) {
    const auto opcode = words[0] & spv::OpCodeMask;
    if (opcode == spv::OpVariable && format_of_.contains(words[2])) return declare(words[2]);
    if (opcode == spv::OpAccessChain && format_of_.contains(words[3])) {
      places_[words[2]] = {words[3], words[5]};  // behind the index of the block's only member
      return;
    }
    if (opcode == spv::OpLoad && places_.contains(words[3])) return load(words[2], places_.at(words[3]));
    if (opcode == spv::OpStore && places_.contains(words[1])) return store(words[2], places_.at(words[1]));
    result_.insert(result_.end(), words.begin(), words.end());
  }

  void declare(std::uint32_t variable) {
    const VkFormat format = format_of_.at(variable);
    TexelTypes& types = types_.at(format);
    if (!types.vector) write(spv::OpTypeVector, {types.vector = bound_++, types.scalar, 4});
    if (!types.image) {
      const std::uint32_t no_depth = 0, no_layers = 0, no_samples = 0, without_sampler = 2;
      write(spv::OpTypeImage, {types.image = bound_++, types.scalar, spv::DimBuffer, no_depth, no_layers, no_samples,
                               without_sampler, image_format_of(format)});
      write(spv::OpTypePointer, {types.pointer = bound_++, spv::StorageClassUniformConstant, types.image});
    }
    write(spv::OpVariable, {types.pointer, variable, spv::StorageClassUniformConstant});
  }

  void load(std::uint32_t result, const Place& place) {
    const VkFormat format = format_of_.at(place.variable);
    const TexelTypes& types = types_.at(format);
    const bool is_whole = format == VK_FORMAT_R32G32B32A32_SFLOAT;
    const std::uint32_t image = bound_++, texel = is_whole ? result : bound_++, first = 0;
    write(spv::OpLoad, {types.image, image, place.variable});
    write(spv::OpImageRead, {types.vector, texel, image, place.index});
    if (!is_whole) write(spv::OpCompositeExtract, {types.scalar, result, texel, first});
  }

  void store(std::uint32_t value, const Place& place) {
    const VkFormat format = format_of_.at(place.variable);
    const TexelTypes& types = types_.at(format);
    const bool is_whole = format == VK_FORMAT_R32G32B32A32_SFLOAT;
    const std::uint32_t image = bound_++, texel = is_whole ? value : bound_++;
    write(spv::OpLoad, {types.image, image, place.variable});
    if (!is_whole) write(spv::OpCompositeConstruct, {types.vector, texel, value, value, value, value});
    write(spv::OpImageWrite, {image, place.index, texel});
  }

  void write(spv::Op opcode, std::initializer_list<std::uint32_t> operands) {
    result_.push_back(opening(opcode, std::uint32_t(1 + operands.size())));
    result_.insert(result_.end(), operands);
  }

  std::span<const std::uint32_t> code_;
  std::vector<std::uint32_t> result_;
  std::uint32_t bound_;                          // the least id that is free
  std::map<std::uint32_t, VkFormat> format_of_;  // of variables
  std::map<VkFormat, TexelTypes> types_;
  std::map<std::uint32_t, Place> places_;  // of pointers
};

}  // namespace

std::vector<std::uint32_t> with_texels(std::span<const std::uint32_t> code, std::span<const Block> blocks) {
  return TexelWriter(code, blocks).written();
}

std::span<const std::uint32_t> code_for(const std::string& stem, const Reflection& all,
                                        const std::vector<std::uint32_t>& specialization) {
  const auto usual = kernel_code(stem + "_usual");
  if (usual.empty()) return kernel_code(stem);
  const auto left = reflect(usual).constants;
  const bool is_usual = std::ranges::all_of(all.constants, [&](const auto& constant) {
    return left.contains(constant.first) || specialization.at(constant.first) == constant.second;
  });
  return is_usual ? usual : kernel_code(stem);
}

VkDescriptorType descriptor_of(const Block& block) {
  const bool is_texels = block.texel != VK_FORMAT_UNDEFINED;
  return is_texels ? VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

Kernel::Kernel(Device& device, const std::string& stem, const std::vector<std::uint32_t>& specialization,
               bool reads_texels)
    : stem_(stem) {
  const auto code = kernel_code(stem);
  if (code.empty()) fail(ErrorKind::device, "there is no kernel {}", stem);
  reflection_ = reflect(code);
  if (!reads_texels)
    for (Block& block : reflection_.blocks) block.texel = VK_FORMAT_UNDEFINED;
  std::vector<std::uint32_t> ids;
  for (const auto& constant : reflection_.constants) ids.push_back(constant.first);
  if (ids.size() != specialization.size() || (!specialization.empty() && ids.back() != specialization.size() - 1))
    fail(ErrorKind::device, "kernel {} has specialization constants {{{}}}, and {} are given", stem,
         fmt::join(ids, ", "), specialization.size());
  if (const std::uint32_t most = std::min(kMostBlocks, device.most_blocks()); reflection_.blocks.size() > most)
    fail(ErrorKind::device, "kernel {} has {} storage buffers, and {} takes {}", stem, reflection_.blocks.size(),
         device.info().name, most);
  create_layouts(device);
  std::vector<std::uint32_t> edited;
  auto own = code_for(stem, reflection_, specialization);
  if (reads_texels) own = edited = with_texels(own, reflection_.blocks);
  if (device.preserves_nan()) own = edited = with_preserved_nan(own);
  create_pipeline(device, own, specialization);
}

void Kernel::create_layouts(Device& device) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const auto& block : reflection_.blocks)
    bindings.push_back({block.binding, descriptor_of(block), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  auto set_info = structure<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  set_info.bindingCount = std::uint32_t(bindings.size());
  set_info.pBindings = bindings.data();
  make(set_layout_, device.handle(), vkCreateDescriptorSetLayout, set_info, "vkCreateDescriptorSetLayout");

  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, reflection_.parameter_bytes};
  auto layout_info = structure<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layout_info.setLayoutCount = 1;
  const VkDescriptorSetLayout set_layout = set_layout_;
  layout_info.pSetLayouts = &set_layout;
  layout_info.pushConstantRangeCount = range.size ? 1 : 0;
  layout_info.pPushConstantRanges = &range;
  make(layout_, device.handle(), vkCreatePipelineLayout, layout_info, "vkCreatePipelineLayout");
}

void Kernel::create_pipeline(Device& device, std::span<const std::uint32_t> code,
                             const std::vector<std::uint32_t>& specialization) {
  auto module_info = structure<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  module_info.codeSize = code.size_bytes();
  module_info.pCode = code.data();
  DeviceHandle<VkShaderModule, vkDestroyShaderModule> module;
  make(module, device.handle(), vkCreateShaderModule, module_info, "vkCreateShaderModule");

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t id = 0; id < specialization.size(); id++) entries.push_back({id, id * 4, 4});
  const VkSpecializationInfo constants{std::uint32_t(entries.size()), entries.data(), specialization.size() * 4,
                                       specialization.data()};
  auto info = structure<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT;  // a dispatch may be cut into slices: see recorder.h
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &constants;
  info.layout = layout_;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  pipeline_ = {device.handle(), pipeline};
}

}  // namespace alcove::gpu
