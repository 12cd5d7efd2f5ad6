// Pictures of other formats in, and charts out, through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
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

/// A picture of one number per pixel, with a scale below it. Debug views are drawn so.
struct Chart {
  int width, height;             // px; small pictures are drawn with larger pixels
  std::vector<float> places;     // on the scale, 0 to 1; NaN: sky, which has a colour of its own
  std::string title, low, high;  // texts: what it shows, and the numbers at the ends of the scale
  std::string made_by;           // see encode_png()
  bool is_grey;                  // black to white; else a ramp that brightens evenly
};

/// Display values of sky in pictures: no grey, not on a chart's ramp, and no normal that faces the camera.
inline constexpr std::array kSkyColor{0.74f, 0.4f, 0.36f};

/// Why neither pictures of other formats than EXR and DDS can be read nor charts drawn; empty where they can.
std::string why_no_image_io();

/// Opens a picture of any format that OpenImageIO reads. Fails with ErrorKind::input, also if a header claims more
/// pixels than its file can hold; `option` is for the message.
std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option);

/// Draws a chart as an 8-bit colour PNG. Fails with ErrorKind::output, also if the font for its texts is missing.
std::vector<char> encode_chart(const std::string& name, const Chart& chart);

}  // namespace alcove
