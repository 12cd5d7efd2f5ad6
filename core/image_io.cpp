// OpenImageIO, wrapped: the only file that includes it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/file.h"

namespace alcove {

void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels) {
  std::vector<unsigned char> bytes(pixels.size());
  std::ranges::transform(pixels, bytes.begin(), [](float x) { return static_cast<unsigned char>(std::lround(255 * std::clamp(x, 0.0f, 1.0f))); });
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput memory(encoded);
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeUInt8);
  const auto writer = OIIO::ImageOutput::create("png", &memory);
  if (!writer || !writer->open(path, spec) || !writer->write_image(OIIO::TypeUInt8, bytes.data()) || !writer->close())
    fail(ErrorKind::output, "{}: could not be encoded as PNG: {}", path, writer ? writer->geterror() : OIIO::geterror());
  write_whole(path, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
}

}  // namespace alcove
