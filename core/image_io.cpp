// OpenImageIO, wrapped: the only file that includes it. A module of its own; core/image_io_module.h says why.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/image_io_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/file.h"

namespace alcove {
namespace {

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

Image read_image(const std::string& path, const char* option) {
  require_readable(path, "picture", option);
  OIIO::ImageSpec as_stored;
  as_stored["oiio:UnassociatedAlpha"] = 1;
  const auto reader = OIIO::ImageInput::open(path, &as_stored);
  if (!reader) fail(ErrorKind::input, "{}: not a picture that can be read ({}): {}", path, option, one_line(OIIO::geterror()));
  const OIIO::ImageSpec spec = reader->spec();
  if (spec.deep || spec.depth > 1) fail(ErrorKind::input, "{}: a deep or volume picture, which has no single value a pixel ({})", path, option);
  std::vector<float> interleaved(spec.image_pixels() * std::size_t(spec.nchannels));
  if (!reader->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, interleaved.data()))
    fail(ErrorKind::input, "{}: the pixels cannot be read, the file is damaged or incomplete: {}", path, one_line(reader->geterror()));
  Image image({spec.x, spec.y, spec.width, spec.height}, {spec.full_x, spec.full_y, spec.full_width, spec.full_height}, spec.channelnames);
  for (std::size_t c = 0; c < image.names.size(); c++)
    for (std::size_t i = 0; i < image.data.pixels(); i++) image.plane(c)[i] = interleaved[i * image.names.size() + c];
  return image;
}

std::vector<char> encode_png(const std::string& name, int width, int height, int channels, std::span<const float> pixels) {
  std::vector<unsigned char> bytes(pixels.size());
  std::ranges::transform(pixels, bytes.begin(), [](float x) { return static_cast<unsigned char>(std::lround(255 * std::clamp(x, 0.0f, 1.0f))); });
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput memory(encoded);
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeUInt8);
  const auto writer = OIIO::ImageOutput::create("png", &memory);
  if (!writer || !writer->open(name, spec) || !writer->write_image(OIIO::TypeUInt8, bytes.data()) || !writer->close())
    fail(ErrorKind::output, "{}: could not be encoded as PNG: {}", name, writer ? writer->geterror() : OIIO::geterror());
  return {encoded.begin(), encoded.end()};
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const ImageIoModule alcove_image_io_module = {read_image, encode_png};

}  // namespace alcove
