// The pixels of a picture that is no EXR, some rows at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace alcove {

/// A picture whose header has been read. Its first image, as it is stored: integer formats become 0 to 1, no colour is
/// converted, no alpha multiplied in.
class PictureReader {
 public:
  virtual ~PictureReader() = default;

  /// Where pixels are, as the file says, from 0, 0 for most formats; a name a channel.
  Window data, display;
  std::vector<std::string> names;

  struct Channel {
    std::size_t index;  // of names
    float* to;          // row by row
  };
  /// `rows` rows from the `first` one on; no more is held at a time than a few of them. Fails with ErrorKind::input.
  virtual void read(int first, int rows, std::span<const Channel> channels) = 0;
};

}  // namespace alcove
