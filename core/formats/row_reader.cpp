// DDS and NumPy's arrays: a header, then pixels one behind the other, all of the same size.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/half.h"
#include "core/base/text.h"
#include "core/formats/image_io.h"
#include "core/formats/sample_loops.h"

namespace alcove {
namespace {

/// Checks the length of a file of pixels, and reads its rows.
class RowReader : public PictureReader {
 public:
  /// `format` is for messages, as "DDS".
  RowReader(const std::string& path, const char* option, const char* format);

  void read(int first, int rows, std::span<const Channel> channels) override;

 protected:
  /// Decodes one channel of a pixel.
  virtual float sample_of(const char* pixel, std::size_t channel) const = 0;

  /// Fails with ErrorKind::input.
  [[noreturn]] void refuse(const std::string& why) const;
  /// Reads the next bytes; fails where the file ends before.
  void next(void* to, std::size_t bytes);
  /// The picture begins here. Fails where the file is too short for it. A size is at most kMostPixels.
  void begin(std::uint32_t width, std::uint32_t height, std::size_t pixel_bytes);

  static constexpr std::uint32_t kMostPixels = 1u << 16;  // in width and in height

 private:
  const std::string path_, option_, format_;
  std::ifstream file_;
  std::size_t pixel_bytes_ = 0;
  std::uint64_t pixels_ = 0;  // their place in the file
};

RowReader::RowReader(const std::string& path, const char* option, const char* format)
    : path_(path), option_(option), format_(format) {
  require_readable(path, format, option);
  file_.open(path, std::ios::binary);
}

void RowReader::refuse(const std::string& why) const {
  fail(ErrorKind::input, "{}: the {} file cannot be read: {} ({})", path_, format_, why, option_);
}

void RowReader::next(void* to, std::size_t bytes) {
  if (!file_.read(static_cast<char*>(to), std::streamsize(bytes))) refuse("it ends too early");
}

void RowReader::begin(std::uint32_t width, std::uint32_t height, std::size_t pixel_bytes) {
  if (width == 0 || height == 0 || width > kMostPixels || height > kMostPixels)
    refuse(fmt::format("its header is damaged, or it is empty or wider or higher than {} pixels", kMostPixels));
  data = display = {0, 0, int(width), int(height)};
  pixel_bytes_ = pixel_bytes;
  pixels_ = std::uint64_t(file_.tellg());
  std::error_code error;
  const auto size = std::filesystem::file_size(path_, error);
  if (error || size < pixels_ || (size - pixels_) / pixel_bytes < data.pixels())
    refuse(fmt::format("it ends too early: it should hold {} x {} pixels", width, height));
}

void RowReader::read(int first, int rows, std::span<const Channel> channels) {
  std::vector<char> row(std::size_t(data.width) * pixel_bytes_);
  file_.clear();
  file_.seekg(std::streamoff(pixels_ + std::size_t(first) * row.size()));
  for (std::size_t to = 0; to < std::size_t(rows) * std::size_t(data.width); to += std::size_t(data.width)) {
    next(row.data(), row.size());
    for (const Channel& channel : channels)
      for (std::size_t x = 0; x < std::size_t(data.width); x++)
        channel.to[to + x] = sample_of(row.data() + x * pixel_bytes_, channel.index);
  }
}

// DDS: a header of 32-bit words. Source of the format: Microsoft's programming guide for DDS, and its list of DXGI
// formats.

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

// NumPy's arrays: a header that is a Python dictionary. Source of the format: numpy.lib.format.

constexpr std::size_t kMostHeader = 4096;  // bytes; that of a plain array has 118

/// Infinite where it is beyond a float's range.
float as_float(double number) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::isfinite(number) && std::abs(number) > kMost ? float(std::copysign(INFINITY, number)) : float(number);
}

struct Type {
  const char* name;  // a letter, and the bytes of a number
  float (*value)(const char*);
};
constexpr Type kTypes[] = {
    {"f2", [](const char* at) { return from_half(number_at<std::uint16_t>(at)); }},
    {"f4", [](const char* at) { return number_at<float>(at); }},
    {"f8", [](const char* at) { return as_float(number_at<double>(at)); }},
    {"u1", [](const char* at) { return float(number_at<std::uint8_t>(at)) / 255; }},
    {"u2", [](const char* at) { return float(number_at<std::uint16_t>(at)) / 65535; }},
    {"i4", [](const char* at) { return float(number_at<std::int32_t>(at)); }},
};

class NpyReader : public RowReader {
 public:
  NpyReader(const std::string& path, const char* option) : RowReader(path, option, "NumPy") {
    std::array<char, 12> start{};  // six letters, the version, and the length of the header
    next(start.data(), 10);
    if (start[6] > 1) next(start.data() + 10, 2);
    const std::size_t size = start[6] > 1 ? number_at<std::uint32_t>(&start[8]) : number_at<std::uint16_t>(&start[8]);
    std::string header(std::min(size, kMostHeader), ' ');
    next(header.data(), header.size());
    const std::string type = text_of(header, "'descr':", '\'', '\''), shape = text_of(header, "'shape':", '(', ')');
    type_ = std::ranges::find(kTypes, type.substr(std::min<std::size_t>(1, type.size())), &Type::name);
    if (size > kMostHeader) refuse(fmt::format("its header has {} bytes, and that of a plain array has 118", size));
    if (type_ == std::end(kTypes))
      refuse(fmt::format("its numbers are {}: save array.astype('float32')",
                         type.empty() ? "records" : "of the type " + type));
    if (header.find("True") != header.npos) refuse("it is in Fortran's order: save numpy.ascontiguousarray(array)");
    auto sizes = split(shape);
    std::erase(sizes, "");  // behind the last comma
    if (sizes.size() == 2) sizes.emplace_back("1");
    const auto size_of = [&](std::size_t i) { return std::uint32_t(std::min(1e6, number_of(sizes[i]).value_or(0))); };
    if (sizes.size() != 3 || shape.find_first_not_of("0123456789, ") != shape.npos || size_of(2) < 1 || size_of(2) > 4)
      refuse(
          fmt::format("its shape is ({}), and a picture has (height, width), or 1 to 4 channels behind these: "
                      "save array.squeeze(), or numpy.moveaxis(array, 0, -1) where channels come first",
                      shape));
    names = size_of(2) == 1 ? std::vector<std::string>{"Z"} : std::vector<std::string>{"R", "G", "B", "A"};
    names.resize(size_of(2));
    is_reversed_ = type[0] == '>';
    begin(size_of(1), size_of(0), names.size() * bytes());
  }

 private:
  std::size_t bytes() const { return std::size_t(type_->name[1] - '0'); }

  /// What stands between two marks behind a key; "" where nothing does.
  static std::string text_of(const std::string& header, const std::string& key, char from, char to) {
    const std::size_t name = std::min(header.find(key), header.size()),
                      begin = header.find_first_not_of(' ', name + key.size());
    const std::size_t end = begin == header.npos || header[begin] != from ? header.npos : header.find(to, begin + 1);
    return end == header.npos ? "" : header.substr(begin + 1, end - begin - 1);
  }

  float sample_of(const char* pixel, std::size_t channel) const override {
    std::array<char, 8> number{};
    std::copy_n(pixel + channel * bytes(), bytes(), number.begin());
    if (is_reversed_) std::reverse(number.begin(), number.begin() + std::ptrdiff_t(bytes()));
    return type_->value(number.data());
  }

  const Type* type_;
  bool is_reversed_;  // the highest byte of a number comes first
};

}  // namespace

std::unique_ptr<PictureReader> open_dds(const std::string& path, const char* option) {
  return std::make_unique<DdsReader>(path, option);
}

std::unique_ptr<PictureReader> open_npy(const std::string& path, const char* option) {
  return std::make_unique<NpyReader>(path, option);
}

}  // namespace alcove
