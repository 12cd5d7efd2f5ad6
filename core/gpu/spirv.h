// What a kernel's SPIR-V says of itself, and what is declared in it for devices that understand it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace alcove::gpu {

/// A storage buffer of a kernel, in descriptor set 0.
struct Block {
  std::string name;  // in GLSL
  std::uint32_t binding;
  bool is_read, is_written;  // it is not writeonly, and not readonly
};

/// What a kernel's SPIR-V says of itself.
struct Reflection {
  std::vector<Block> blocks;
  std::uint32_t parameter_bytes = 0;     // of the push constant block
  std::uint32_t group[3] = {1, 1, 1};    // invocations of a workgroup
  std::set<std::uint32_t> constant_ids;  // specialization constants
};
/// Fails with ErrorKind::device on code that is no SPIR-V of the kind our kernels compile to.
Reflection reflect(std::span<const std::uint32_t> code);

/// The same code with the mode SignedZeroInfNanPreserve for 32-bit floats. Without it a driver may assume that no value
/// is NaN or infinite, and kernels compare with infinity (kSkyDepth squared, an endless thickness). The code must be of
/// SPIR-V 1.4 or later with one entry point, and the device must have shaderSignedZeroInfNanPreserveFloat32.
std::vector<std::uint32_t> with_preserved_nan(std::span<const std::uint32_t> code);

}  // namespace alcove::gpu
