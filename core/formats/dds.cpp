// DDS: a header of 32-bit words, then rows of pixels. Source of the format: Microsoft's programming guide for DDS, and
// its list of DXGI formats.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/half.h"
#include "core/formats/row_reader.h"
#include "core/formats/sample_loops.h"

namespace alcove {
namespace {

constexpr std::size_t kHeaderWords = 32, kDx10Words = 5;  // the first with the four letters at the beginning
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
    {16, Sample::single_float, 2, 8},  {19, Sample::single_float, 1, 8},    {20, Sample::single_float, 1, 8},
    {21, Sample::single_float, 1, 8},  {24, Sample::ten_ten_ten_two, 4, 4}, {28, Sample::unorm8, 4, 4},
    {34, Sample::half_float, 2, 4},    {35, Sample::unorm16, 2, 4},         {39, Sample::single_float, 1, 4},
    {40, Sample::single_float, 1, 4},  {41, Sample::single_float, 1, 4},    {44, Sample::unorm24, 1, 4},
    {45, Sample::unorm24, 1, 4},       {46, Sample::unorm24, 1, 4},         {53, Sample::unorm16, 1, 2},
    {54, Sample::half_float, 1, 2},    {55, Sample::unorm16, 1, 2},         {56, Sample::unorm16, 1, 2},
    {111, Sample::half_float, 1, 2},   {112, Sample::half_float, 2, 4},     {113, Sample::half_float, 4, 8},
    {114, Sample::single_float, 1, 4}, {115, Sample::single_float, 2, 8},   {116, Sample::single_float, 4, 16},
};

/// Decodes one channel of a pixel.
float decoded(const Format& format, const char* pixel, std::size_t channel) {
  switch (format.sample) {
    case Sample::single_float: return number_at<float>(pixel + 4 * channel);
    case Sample::half_float: return from_half(number_at<std::uint16_t>(pixel + 2 * channel));
    case Sample::unorm16: return float(number_at<std::uint16_t>(pixel + 2 * channel)) / 65535;
    case Sample::unorm8: return float(std::uint8_t(pixel[channel])) / 255;
    case Sample::unorm24: return float((number_at<std::uint32_t>(pixel) & 0xffffff) / double(0xffffff));
    case Sample::ten_ten_ten_two:
      return channel == 3 ? float(number_at<std::uint32_t>(pixel) >> 30) / 3
                          : float((number_at<std::uint32_t>(pixel) >> (10 * channel)) & 1023) / 1023;
  }
  return 0;
}

class DdsReader : public RowReader {
 public:
  DdsReader(const std::string& path, const char* option) : RowReader(path, option, "DDS") {
    std::array<std::uint32_t, kHeaderWords + kDx10Words> words{};
    next(words.data(), 4 * kHeaderWords);
    const std::uint32_t letters = words[21];
    const bool has_dx10 = letters == kDx10;
    if (has_dx10) next(words.data() + kHeaderWords, 4 * kDx10Words);
    const std::uint32_t code = has_dx10 ? words[kHeaderWords] : letters;
    if (words[1] != 124 || words[19] != 32) refuse("its header is damaged");
    format_ = std::ranges::find(kFormats, code, &Format::code);
    if (format_ == std::end(kFormats) || (!has_dx10 && code < 100))
      refuse(
          fmt::format("it has the format {}: save depth as R32, D24 or R16 and normals as RGBA16F, RGBA8 or "
                      "R10G10B10A2, or as EXR",
                      code));
    begin(words[4], words[3], format_->bytes);
    names = {"R", "G", "B", "A"};
    names.resize(std::size_t(format_->channels));
  }

 private:
  float sample_of(const char* pixel, std::size_t channel) const override { return decoded(*format_, pixel, channel); }

  const Format* format_ = nullptr;
};

}  // namespace

std::unique_ptr<PictureReader> open_dds(const std::string& path, const char* option) {
  return std::make_unique<DdsReader>(path, option);
}

}  // namespace alcove
