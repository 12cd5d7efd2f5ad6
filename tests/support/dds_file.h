// Writes DDS files of any format and pixels, and reads them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "tests/support/whole_picture.h"

namespace alcove::test {

/// These words as the bytes of a file.
inline std::string words(const std::vector<std::uint32_t>& values) {
  return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

/// A DDS file with the newer header.
inline std::string dds(std::uint32_t width, std::uint32_t height, std::uint32_t format, const std::string& pixels) {
  std::vector<std::uint32_t> header(32 + 5);
  std::memcpy(header.data(), "DDS ", 4);
  header[1] = 124;
  header[3] = height;
  header[4] = width;
  header[19] = 32;
  std::memcpy(&header[21], "DX10", 4);
  header[32] = format;
  header[33] = 3;
  header[35] = 1;
  return words(header) + pixels;
}

inline Image read_dds(const std::string& path) { return whole(*open_dds(path, "--depth")); }

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()};
}

}  // namespace alcove::test
