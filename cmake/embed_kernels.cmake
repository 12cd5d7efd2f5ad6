# Writes OUTPUT, a C++ source with the SPIR-V files FILES (separated by commas) as word arrays, found by stem.
# SPDX-License-Identifier: BSD-3-Clause
string(REPLACE "," ";" files "${FILES}")
set(arrays "")
set(cases "")
foreach(file ${files})
  get_filename_component(stem "${file}" NAME_WE)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
  string(APPEND arrays "constexpr std::uint32_t k_${stem}[] = {${words}};\n")
  string(APPEND cases "  if (stem == \"${stem}\") return k_${stem};\n")
endforeach()
file(WRITE "${OUTPUT}"
  "// Generated from kernels/ by cmake/embed_kernels.cmake.\n#include \"core/gpu/kernel.h\"\n\nnamespace alcove::gpu {\nnamespace {\n${arrays}}  // namespace\n\n"
  "std::span<const std::uint32_t> kernel_code(std::string_view stem) {\n${cases}  return {};\n}\n\n}  // namespace alcove::gpu\n")
