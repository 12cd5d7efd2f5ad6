// What a kernel's SPIR-V says of itself, and what is declared in it for devices that understand it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

namespace alcove::gpu {

/// What a kernel's SPIR-V says of itself.
struct Reflection {
  std::set<std::uint32_t> bindings;       // storage buffers of descriptor set 0
  std::set<std::uint32_t> read, written;  // those of them that are not writeonly, and not readonly
  std::uint32_t parameter_bytes = 0;      // of the push constant block
  std::uint32_t group[3] = {1, 1, 1};     // invocations of a workgroup
  std::set<std::uint32_t> constant_ids;   // specialization constants
};
/// Fails with ErrorKind::device on code that is no SPIR-V of the kind our kernels compile to.
Reflection reflect(std::span<const std::uint32_t> code);

/// The same code with the mode SignedZeroInfNanPreserve for 32-bit floats. Without it a driver may assume that no value
/// is NaN or infinite, and kernels compare with infinity (kSkyDepth squared, an endless thickness). The code must be of
/// SPIR-V 1.4 or later with one entry point, and the device must have shaderSignedZeroInfNanPreserveFloat32.
std::vector<std::uint32_t> with_preserved_nan(std::span<const std::uint32_t> code);

}  // namespace alcove::gpu
