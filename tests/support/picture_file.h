// Writes pictures of the formats that OpenImageIO knows by a name's ending.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/formats/image_io.h"
#include "tests/support/test.h"

namespace alcove::test {

inline void write_picture(const std::string& path, const OIIO::ImageSpec& spec, const std::vector<float>& pixels) {
  const auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out && out->open(path, spec)) << path;
  ASSERT_TRUE(out->write_image(OIIO::TypeFloat, pixels.data()) && out->close()) << path << out->geterror();
}

// All pixels of a picture that is no EXR.

inline Image whole(PictureReader& picture) {
  Image image(picture.data, picture.display, picture.names);
  std::vector<PictureReader::Channel> channels;
  for (std::size_t i = 0; i < image.names.size(); i++) channels.push_back({i, image.plane(i).data()});
  picture.read(0, image.data.height, channels);
  return image;
}

// Writes DDS files of any format and pixels, and reads them.

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

// Pictures made by whole-number formulas, so that a program in another language makes the same bits.

constexpr int kFormulaWidth = 48, kFormulaHeight = 40;

/// ((a x^2 + b y^2 + c x y) mod m) / (m - 1): smooth in places, noise in others.
inline std::vector<float> formula_plane(int a, int b, int c, int m) {
  std::vector<float> plane;
  for (int y = 0; y < kFormulaHeight; y++)
    for (int x = 0; x < kFormulaWidth; x++)
      plane.push_back(float(double((x * x * a + y * y * b + x * y * c) % m) / (m - 1)));
  return plane;
}

/// Clamped (k x + 2 y + d) / (48 k + 80): a ramp.
inline std::vector<float> ramp_plane(int d, int k) {
  std::vector<float> plane;
  for (int y = 0; y < kFormulaHeight; y++)
    for (int x = 0; x < kFormulaWidth; x++)
      plane.push_back(
          float(std::clamp(double(x * k + 2 * y + d) / (kFormulaWidth * k + 2 * kFormulaHeight), 0.0, 1.0)));
  return plane;
}

/// A ramp with a box of 0.9 in columns 15 to 29 and rows 10 to 19.
inline std::vector<float> ramp_with_box() {
  auto plane = ramp_plane(0, 1);
  for (int y = 10; y < 20; y++) std::fill_n(plane.begin() + y * kFormulaWidth + 15, 15, 0.9f);
  return plane;
}

using ColorImage = std::array<std::vector<float>, 3>;
inline ColorImage noise_reference() {
  return {formula_plane(1, 3, 1, 256), formula_plane(2, 1, 3, 200), formula_plane(1, 1, 5, 300)};
}
inline ColorImage noise_result() {
  return {formula_plane(1, 3, 2, 256), formula_plane(2, 1, 3, 210), formula_plane(1, 2, 5, 300)};
}

}  // namespace alcove::test
