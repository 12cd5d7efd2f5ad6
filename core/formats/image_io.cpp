// OpenImageIO, wrapped: the only file that includes it. A module of its own; core/formats/image_io_module.h says why.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/image_io_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/formats/png.h"

namespace alcove {
namespace {

/// Decoders go on after an error and tell the next one.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

// pixels' bytes that a byte of a file may stand for where formats pack them: deflate packs 1032, of 8 pixels each
constexpr std::uint64_t kDensest = 1 << 14;
constexpr std::size_t kBlockBytes = 1 << 20;  // of pixels that are decoded at once, or one row

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
      fail(ErrorKind::input, "{}: a deep or volume picture, which has no single value a pixel ({})", path, option);
    data = {spec.x, spec.y, spec.width, spec.height};
    display = {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
    names = spec.channelnames;
    // TIFF alone is always decoded strip by strip, and may pack one colour without end.
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
      // That of TIFF says that all went well, and gives zeros, where the file ends too early.
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

std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option) {
  return std::make_unique<OiioReader>(path, option);
}

constexpr int kLegend = 48, kMargin = 8, kStripX = 110, kStrip = 200, kStripHeight = 14;  // px
constexpr int kLeastWidth = 560, kLargestPixel = 8;                                       // px
// display values; neither grey nor on the ramp
constexpr std::array kSkyColor{0.74f, 0.4f, 0.36f};

/// Display values of a place on the scale.
std::array<float, 3> color_at(const OIIO::ImageBuf& ramp, float place, bool is_grey) {
  if (std::isnan(place)) return kSkyColor;
  if (is_grey) return {place, place, place};
  std::array<float, 3> color{};
  ramp.getpixel(int(std::lround(place * float(ramp.spec().width - 1))), 0, color.data(), 3);
  // OpenImageIO's ramps are linear light
  for (float& c : color) c = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return color;
}

/// The colour ramp, one row.
OIIO::ImageBuf make_ramp() {
  OIIO::ImageBuf places(OIIO::ImageSpec(256, 1, 1, OIIO::TypeFloat));
  for (int x = 0; x < 256; x++) {
    const float place = float(x) / 255;
    places.setpixel(x, 0, &place, 1);
  }
  return OIIO::ImageBufAlgo::color_map(places, 0, "viridis");
}

void write_text(OIIO::ImageBuf& picture, const std::string& name, int x, int y, const std::string& text) {
  if (!OIIO::ImageBufAlgo::render_text(picture, x, y, text, 15, "DejaVuSans", {0.9f, 0.9f, 0.9f}))
    fail(ErrorKind::output, "{}: its texts need the font DejaVu Sans (Debian package fonts-dejavu-core): {}", name,
         first_line(picture.geterror()));
}

std::vector<char> encode_chart(const std::string& name, const Chart& chart) {
  const int zoom = std::min((kLeastWidth + chart.width - 1) / chart.width, kLargestPixel),
            width = std::max(zoom * chart.width, kLeastWidth), top = zoom * chart.height;
  OIIO::ImageBuf picture(OIIO::ImageSpec(width, top + kLegend, 3, OIIO::TypeFloat), OIIO::InitializePixels::Yes);
  const OIIO::ImageBuf ramp = make_ramp();
  const auto fill = [&](int x, int y, int w, int h, std::array<float, 3> color) {
    OIIO::ImageBufAlgo::fill(picture, OIIO::cspan<float>(color.data(), 3), OIIO::ROI(x, x + w, y, y + h));
  };
  for (int y = 0; y < top; y++)
    for (int x = 0; x < zoom * chart.width; x++)
      picture.setpixel(
          x, y,
          color_at(ramp, chart.places[std::size_t(y / zoom) * std::size_t(chart.width) + std::size_t(x / zoom)],
                   chart.is_grey)
              .data(),
          3);
  const int strip = top + kLegend - kStripHeight - kMargin, baseline = strip + kStripHeight - 2,
            right = kStripX + kStrip + kMargin;
  for (int x = 0; x < kStrip; x++)
    fill(kStripX + x, strip, 1, kStripHeight, color_at(ramp, float(x) / float(kStrip - 1), chart.is_grey));
  write_text(picture, name, kMargin, top + 18, chart.title);
  write_text(picture, name, kMargin, baseline, chart.low);
  write_text(picture, name, right, baseline, chart.high);
  fill(right + 110, strip, kStripHeight, kStripHeight, kSkyColor);
  write_text(picture, name, right + 110 + kStripHeight + kMargin, baseline, "sky");
  std::vector<float> pixels(std::size_t(width) * std::size_t(top + kLegend) * 3);
  picture.get_pixels(picture.roi(), OIIO::TypeFloat, pixels.data());
  return encode_png(name, width, top + kLegend, 3, pixels, chart.made_by);
}

}  // namespace

extern "C" __attribute__((visibility("default")))
const ImageIoModule alcove_image_io_module = {open_picture, encode_chart};

}  // namespace alcove
