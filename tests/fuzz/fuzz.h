// What the fuzz targets share: an input as a file, and what must hold whatever it says.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/base/error.h"

/// One input of a fuzz target; libFuzzer, or replay.cpp, calls it. Returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace alcove::fuzz {

/// Of larger pictures no pixels are decoded, so that thousands of inputs can be tried in a second.
constexpr std::size_t kMostPixels = std::size_t(1) << 16;

/// The input as a regular file that lies in memory only.
class InputFile {
 public:
  InputFile(const std::uint8_t* data, std::size_t size);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

/// Ends the program with the words unless the condition holds.
void require(bool condition, const char* words);

/// Calls the function, which may refuse its input with an Error that says why, and with no other exception. Whether it
/// did not.
template <class Function>
bool accepts(Function&& function) {
  try {
    function();
    return true;
  } catch (const Error& error) {
    require(*error.what() != 0, "an error says nothing");
    return false;
  }
}

}  // namespace alcove::fuzz
