// Pictures of other formats in, through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace alcove {

/// A picture whose header has been read, and whose pixels can be read some rows at a time. It gives the first image as
/// it is stored: integers become 0 to 1, no colour is converted and no alpha multiplied in.
class PictureReader {
 public:
  virtual ~PictureReader() = default;

  /// The windows are as the file says; those of most formats begin at 0, 0. There is one name per channel.
  Window data, display;
  std::vector<std::string> names;

  struct Channel {
    std::size_t index;  // of names
    float* to;          // row by row
  };
  /// Reads `rows` rows from the `first` one on, and holds a few of them at a time. Fails with ErrorKind::input.
  virtual void read(int first, int rows, std::span<const Channel> channels) = 0;
};

/// Why pictures of other formats than EXR and DDS cannot be read; empty where they can.
std::string why_no_image_io();

/// Opens a picture of any format that OpenImageIO reads. Fails with ErrorKind::input, also if a header claims more
/// pixels than its file can hold; `option` is for the message.
std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option);

}  // namespace alcove
