// Pictures with pixels one behind the other in a file, all of the same size.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "core/formats/image_io.h"

namespace alcove {

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

}  // namespace alcove
