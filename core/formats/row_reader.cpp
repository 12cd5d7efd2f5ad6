// Checks the length of a file of pixels, and reads its rows.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/row_reader.h"

#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"

namespace alcove {

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

}  // namespace alcove
