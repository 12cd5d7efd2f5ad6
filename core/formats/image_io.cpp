// OpenImageIO, wrapped: the only file that includes it. A module of its own; core/formats/image_io.h says why.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"

namespace alcove {
namespace {

/// Gives the first of several messages: decoders go on after an error, and report the next one too.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

// The most bytes of pixels for one byte of a packed file. Deflate packs 1032 bytes of up to 8 pixels each.
constexpr std::uint64_t kDensest = 1 << 14;
constexpr std::size_t kBlockBytes = 1 << 20;  // of pixels decoded at once, but at least one row

class OiioReader : public PictureReader {
 public:
  OiioReader(const std::string& path, const char* option) : path_(path), option_(option) {
    require_readable(path, "picture", option);
    OIIO::ImageSpec as_stored;
    as_stored["oiio:UnassociatedAlpha"] = 1;
    input_ = OIIO::ImageInput::open(path, &as_stored);
    if (!input_)
      fail(ErrorKind::input, "{}: not a picture that can be read ({}): {}", path, option, first_line(OIIO::geterror()));
    const OIIO::ImageSpec& spec = input_->spec();
    if (spec.deep || spec.depth > 1)
      fail(ErrorKind::input, "{}: a deep or volume picture, which has no single value per pixel ({})", path, option);
    data = {spec.x, spec.y, spec.width, spec.height};
    display = {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
    names = spec.channelnames;
    // Only TIFF is always decoded strip by strip, and may pack one colour without end.
    if (spec.image_bytes(true) / kDensest > OIIO::Filesystem::file_size(path) &&
        std::string_view(input_->format_name()) != "tiff")
      fail(ErrorKind::input, "{}: its header claims {} pixels, which its {} bytes cannot hold ({})", path,
           to_string(data), OIIO::Filesystem::file_size(path), option);
  }

  void read(int first, int rows, std::span<const Channel> channels) override {
    const OIIO::ImageSpec& spec = input_->spec();
    const int together = std::max(1, spec.tile_height);  // rows
    const std::size_t width = std::size_t(data.width), stride = names.size(),
                      row_bytes = width * stride * sizeof(float) * std::size_t(together);
    const int block = together * int(std::clamp<std::size_t>(kBlockBytes / std::max<std::size_t>(1, row_bytes), 1,
                                                             std::size_t(data.height)));
    std::vector<float> interleaved(width * stride * std::size_t(std::min(block, data.height)));
    for (int begin = first / together * together; begin < first + rows; begin += block) {
      const int end = std::min(begin + block, data.height), top = data.y + begin, bottom = data.y + end;
      const bool is_read = spec.tile_width ? input_->read_tiles(0, 0, data.x, data.x + data.width, top, bottom, 0, 1, 0,
                                                                int(stride), OIIO::TypeFloat, interleaved.data())
                                           : input_->read_scanlines(0, 0, top, bottom, 0, 0, int(stride),
                                                                    OIIO::TypeFloat, interleaved.data());
      // If a file ends too early, the reader of TIFF reports success and gives zeros; only has_error() tells.
      if (!is_read || input_->has_error())
        fail(ErrorKind::input, "{}: the pixels cannot be read, the file is damaged or incomplete ({}): {}", path_,
             option_, first_line(input_->geterror()));
      for (const Channel& channel : channels)
        for (int row = std::max(begin, first); row < std::min(end, first + rows); row++)
          for (std::size_t x = 0; x < width; x++)
            channel.to[std::size_t(row - first) * width + x] =
                interleaved[(std::size_t(row - begin) * width + x) * stride + channel.index];
    }
  }

 private:
  std::string path_, option_;
  std::unique_ptr<OIIO::ImageInput> input_;
};

std::unique_ptr<PictureReader> open_by_oiio(const std::string& path, const char* option) {
  return std::make_unique<OiioReader>(path, option);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const ImageIoModule alcove_image_io_module = {open_by_oiio};

}  // namespace alcove
