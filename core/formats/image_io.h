// Pictures that are no EXR, read and written through OpenImageIO.
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

/// Opens a picture of any format that OpenImageIO reads. Fails with ErrorKind::input, also if a header claims more
/// pixels than its file can hold; `option` is for the message.
std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option);

/// Encodes interleaved display values in [0, 1] (clamped), of 1 or 3 channels, as an 8-bit PNG. `name` is for the
/// message of a failure, ErrorKind::output. `made_by` is a text that is kept in the PNG; empty: none.
std::vector<char> encode_png(const std::string& name, int width, int height, int channels,
                             std::span<const float> pixels, const std::string& made_by = "");

/// Draws a chart as an 8-bit colour PNG. Fails with ErrorKind::output, also if the font for its texts is missing.
std::vector<char> encode_chart(const std::string& name, const Chart& chart);

/// Writes an 8-bit PNG, whole or not at all, from interleaved display values in [0, 1] (clamped); 1 or 3 channels.
/// Fails with ErrorKind::output.
void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels,
               const std::string& made_by = "");

/// Whether a PNG of write_png() has that text and was not cut short.
bool is_whole_png(const std::string& path, const std::string& made_by);

}  // namespace alcove
