// DDS: a header of 32-bit words, then rows of pixels. Source of the format: Microsoft's programming guide for DDS, and
// its list of DXGI formats.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/dds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/formats/exr.h"

namespace alcove {
namespace {

constexpr std::size_t kHeaderWords = 32, kDx10Words = 5;  // with the four letters at the beginning
constexpr std::uint32_t kMostPixels = 1u << 16;           // in width and in height
constexpr std::uint32_t kDx10 = 0x30315844;               // "DX10"

enum class Sample { single_float, half_float, unorm16, unorm8, unorm24, ten_ten_ten_two };

struct Format {
  std::uint32_t code;  // DXGI_FORMAT, or the four letters (or their number) of the older header
  Sample sample;
  int channels;
  std::size_t bytes;  // per pixel
};

constexpr Format kFormats[] = {
    {2, Sample::single_float, 4, 16},  {10, Sample::half_float, 4, 8},      {11, Sample::unorm16, 4, 8},
    {16, Sample::single_float, 2, 8},  {24, Sample::ten_ten_ten_two, 4, 4}, {28, Sample::unorm8, 4, 4},
    {34, Sample::half_float, 2, 4},    {35, Sample::unorm16, 2, 4},         {39, Sample::single_float, 1, 4},
    {40, Sample::single_float, 1, 4},  {41, Sample::single_float, 1, 4},    {44, Sample::unorm24, 1, 4},
    {45, Sample::unorm24, 1, 4},       {46, Sample::unorm24, 1, 4},         {53, Sample::unorm16, 1, 2},
    {54, Sample::half_float, 1, 2},    {55, Sample::unorm16, 1, 2},         {56, Sample::unorm16, 1, 2},
    {111, Sample::half_float, 1, 2},   {112, Sample::half_float, 2, 4},     {113, Sample::half_float, 4, 8},
    {114, Sample::single_float, 1, 4}, {115, Sample::single_float, 2, 8},   {116, Sample::single_float, 4, 16},
};

template <class T>
T at(const char* bytes, std::size_t index) {
  T value;
  std::memcpy(&value, bytes + index * sizeof(T), sizeof(T));
  return value;
}

/// Decodes one channel of a pixel. Files and machines are little-endian.
float sample_of(const Format& format, const char* pixel, std::size_t channel) {
  switch (format.sample) {
    case Sample::single_float: return at<float>(pixel, channel);
    case Sample::half_float: return from_half(at<std::uint16_t>(pixel, channel));
    case Sample::unorm16: return float(at<std::uint16_t>(pixel, channel)) / 65535;
    case Sample::unorm8: return float(at<std::uint8_t>(pixel, channel)) / 255;
    case Sample::unorm24: return float((at<std::uint32_t>(pixel, 0) & 0xffffff) / double(0xffffff));
    case Sample::ten_ten_ten_two:
      return channel == 3 ? float(at<std::uint32_t>(pixel, 0) >> 30) / 3
                          : float((at<std::uint32_t>(pixel, 0) >> (10 * channel)) & 1023) / 1023;
  }
  return 0;
}

}  // namespace

Image read_dds(const std::string& path, const char* option) {
  static_assert(std::endian::native == std::endian::little);
  require_readable(path, "DDS", option);
  std::ifstream file(path, std::ios::binary);
  std::array<std::uint32_t, kHeaderWords + kDx10Words> words{};
  const auto read = [&](void* to, std::size_t bytes) {
    if (!file.read(static_cast<char*>(to), std::streamsize(bytes)))
      fail(ErrorKind::input, "{}: the DDS file ends too early ({})", path, option);
  };
  read(words.data(), 4 * kHeaderWords);
  const std::uint32_t height = words[3], width = words[4], letters = words[21];
  const bool has_dx10 = letters == kDx10;
  if (has_dx10) read(words.data() + kHeaderWords, 4 * kDx10Words);
  const std::uint32_t code = has_dx10 ? words[kHeaderWords] : letters;
  const auto* format = std::ranges::find(kFormats, code, &Format::code);
  if (words[1] != 124 || words[19] != 32 || width == 0 || height == 0 || width > kMostPixels || height > kMostPixels)
    fail(ErrorKind::input,
         "{}: the DDS header is damaged, or the texture is empty or wider or higher than {} pixels ({})", path,
         kMostPixels, option);
  if (format == std::end(kFormats) || (!has_dx10 && code < 100))
    fail(ErrorKind::input,
         "{}: DDS format {} is not known: save depth as R32, D24 or R16 and normals as RGBA16F, RGBA8 or R10G10B10A2, "
         "or as EXR ({})",
         path, code, option);
  const std::size_t pixels = std::size_t(width) * height, offset = 4 * (kHeaderWords + (has_dx10 ? kDx10Words : 0));
  std::error_code error;
  if (const auto size = std::filesystem::file_size(path, error);
      error || size < offset || (size - offset) / format->bytes < pixels)
    fail(ErrorKind::input, "{}: the DDS file ends too early: it should hold {} x {} pixels ({})", path, width, height,
         option);
  std::vector<char> bytes(pixels * format->bytes);
  read(bytes.data(), bytes.size());
  std::vector<std::string> names{"R", "G", "B", "A"};
  names.resize(std::size_t(format->channels));
  Image image(int(width), int(height), names);
  for (std::size_t c = 0; c < names.size(); c++)
    for (std::size_t i = 0; i < pixels; i++)
      image.plane(c)[i] = sample_of(*format, bytes.data() + i * format->bytes, c);
  return image;
}

}  // namespace alcove
