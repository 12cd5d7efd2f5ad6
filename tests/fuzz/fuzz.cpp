// Inputs as files in memory, and the end of the program.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/fuzz.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace alcove::fuzz {

InputFile::InputFile(const std::uint8_t* data, std::size_t size)
    : descriptor_(::memfd_create("input", MFD_CLOEXEC)), path_("/proc/self/fd/" + std::to_string(descriptor_)) {
  require(descriptor_ >= 0 && ::write(descriptor_, data, size) == ssize_t(size), "no file in memory");
}

InputFile::~InputFile() { ::close(descriptor_); }

void require(bool condition, const char* words) {
  if (condition) return;
  std::fprintf(stderr, "does not hold: %s\n", words);
  std::abort();
}

}  // namespace alcove::fuzz
