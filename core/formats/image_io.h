// Readers of other picture formats: DDS and NumPy by our own code, PNG by libpng, all others through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace alcove {

/// A picture whose header has been read, and whose pixels can be read some rows at a time. Only the first image is
/// read, as it is stored: integers become 0 to 1, no colour is converted, and no alpha is multiplied in.
class PictureReader {
 public:
  virtual ~PictureReader() = default;

  /// The windows in the file; those of most formats begin at 0, 0. `names` has one name per channel.
  Window data, display;
  std::vector<std::string> names;

  struct Channel {
    std::size_t index;  // of names
    float* to;          // row by row
  };
  /// Reads `rows` rows from the `first` one on, a few at a time. Fails with ErrorKind::input.
  virtual void read(int first, int rows, std::span<const Channel> channels) = 0;
};

/// The reason why pictures of other formats than EXR, DDS, PNG and NumPy cannot be read; empty if they can.
std::string why_no_image_io();

/// Opens a DDS texture as RenderDoc saves it, and reads its first image. Its format must be R32_FLOAT, D32_FLOAT,
/// R16_UNORM, D16_UNORM, R16_FLOAT, R24_UNORM_X8 / D24_UNORM_S8, R32_FLOAT_X8X24 / D32_FLOAT_S8X24, R32G32_FLOAT,
/// R16G16_FLOAT, R16G16_UNORM, R8G8B8A8_UNORM, R10G10B10A2_UNORM, R16G16B16A16 (float and unorm) or
/// R32G32B32A32_FLOAT. The channels are called R, G, B, A, as many as there are; unorm values go from 0 to 1. Fails
/// with ErrorKind::input on other formats, on headers that make no sense, and on files that are too short.
std::unique_ptr<PictureReader> open_dds(const std::string& path, const char* option);

/// Opens a PNG: Y, or R, G, B, each with A if it has any, of 8 or 16 bits. Fails with ErrorKind::input as
/// open_picture() does.
std::unique_ptr<PictureReader> open_png(const std::string& path, const char* option);

/// Opens an array of NumPy's, a .npy file: of height and width, or of up to four channels behind these. One channel is
/// called Z, several R, G, B, A. u1 and u2 go from 0 to 1; f2, f4, f8 and i4 are as they are. Fails with
/// ErrorKind::input on other types and shapes, on Fortran's order, and on files that are too short.
std::unique_ptr<PictureReader> open_npy(const std::string& path, const char* option);

/// Opens a picture of any format that OpenImageIO reads. Fails with ErrorKind::input, also if a header claims more
/// pixels than its file can hold; `option` is for the message.
std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option);

/// The interface between the program and core/formats/image_io.cpp, a module that is loaded on first use. OpenImageIO
/// brings some 200 shared libraries along (video, GIS, computer vision). Loading them takes a fifth of a second, more
/// than the rest of a small frame, and a job with EXRs only needs none of them.
struct ImageIoModule {
  std::unique_ptr<PictureReader> (*open_picture)(const std::string& path, const char* option);
};

inline constexpr const char* kImageIoFile = "libalcove_image_io.so";
inline constexpr const char* kImageIoSymbol = "alcove_image_io_module";  // an ImageIoModule

}  // namespace alcove
