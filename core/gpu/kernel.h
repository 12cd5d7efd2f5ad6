// A compute pipeline made from embedded SPIR-V, whose buffers and parameter size are read from the code itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/gpu/device.h"

namespace alcove::gpu {

/// The most storage buffers of a kernel. Common GPUs take at least 16 per stage; a device that takes fewer is refused
/// when a kernel with more is made.
constexpr std::uint32_t kMostBlocks = 16;

/// A storage buffer of a kernel, in descriptor set 0.
struct Block {
  std::string name;  // in GLSL
  std::uint32_t binding;
  bool is_read, is_written;  // not declared writeonly, not declared readonly
  // The format of its elements if it may be a buffer of texels: an array of floats, uints, or whole vec4, that is read,
  // without atomics.
  VkFormat texel = VK_FORMAT_UNDEFINED;
};

/// The declarations of a kernel, read from its SPIR-V.
struct Reflection {
  std::vector<Block> blocks;
  std::uint32_t parameter_bytes = 0;                 // of the push constant block
  std::uint32_t group[3] = {1, 1, 1};                // invocations of a workgroup
  std::map<std::uint32_t, std::uint32_t> constants;  // values of specialization constants by id, where none is given
};
/// Reads the declarations. Fails with ErrorKind::device on code that is not SPIR-V of the kind that our kernels compile
/// to.
Reflection reflect(std::span<const std::uint32_t> code);

/// The code with the mode SignedZeroInfNanPreserve for 32-bit floats. Without it, a driver may assume that no value is
/// NaN or infinite, but kernels compare with infinity (kSkyDepth squared, an endless thickness). The code must be
/// SPIR-V 1.4 or later with one entry point, and the device must have shaderSignedZeroInfNanPreserveFloat32.
std::vector<std::uint32_t> with_preserved_nan(std::span<const std::uint32_t> code);

/// The code with buffers of texels in place of the storage buffers with a texel format: kernels are written for storage
/// buffers alone. It gives the same bits. Old versions of lavapipe gather texels at once, but read storage buffers in a
/// loop over the lanes, which takes up to ten times as long, depending on the CPU.
std::vector<std::uint32_t> with_texels(std::span<const std::uint32_t> code, std::span<const Block> blocks);

/// The SPIR-V of kernels/FOLDER/STEM.comp, embedded at build time; empty if no kernel has that stem. STEM_usual is its
/// twin, if it has one: the same source with some specialization constants fixed at their defaults. A Kernel with these
/// values takes it by itself. It saves time, since drivers remove dead code only after they have read all of it.
std::span<const std::uint32_t> kernel_code(std::string_view stem);

/// The code that a pipeline with these constants is made of: that of the kernel's twin, if they are its own. `all`: the
/// kernel's declarations.
std::span<const std::uint32_t> code_for(const std::string& stem, const Reflection& all,
                                        const std::vector<std::uint32_t>& specialization);

/// The kind of descriptor that a block is bound by.
VkDescriptorType descriptor_of(const Block& block);

class Kernel {
 public:
  /// Fails with ErrorKind::device if there is no such kernel, if its specialization constants are not 0 .. n-1, or if
  /// it has more storage buffers than the device takes. reads_texels: see with_texels().
  Kernel(Device& device, const std::string& stem, const std::vector<std::uint32_t>& specialization, bool reads_texels);

  const std::string& stem() const { return stem_; }
  const Reflection& reflection() const { return reflection_; }
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }

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
