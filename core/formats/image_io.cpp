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

/// Gives the first of several messages: decoders go on after an error and report the next one.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

// Bytes of pixels that one byte of a packed file may stand for. Deflate packs 1032 bytes of up to 8 pixels each.
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
      fail(ErrorKind::input, "{}: a deep or volume picture, which has no single value per pixel ({})", path, option);
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
      // Where a file ends too early, the reader of TIFF reports success and gives zeros; only has_error() tells.
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

// The layout of a chart's legend, px.
constexpr int kLegend = 48;                       // its height
constexpr int kMargin = 8;                        // around all that stands in it
constexpr int kTextHeight = 15, kTitleBase = 18;  // of a text, and from the legend's top to the base of the title
constexpr int kTextWidth = 110;                   // room for a number on either side of the strip
constexpr int kStrip = 200, kStripHeight = 14;    // the strip of colours
constexpr int kLeastWidth = 560;                  // of a chart: what the legend needs
constexpr int kLargestPixel = 8;                  // small pictures are enlarged so far
constexpr float kTextGrey = 0.9f;                 // display value

/// Gives the display values of a place on the scale.
std::array<float, 3> color_at(const OIIO::ImageBuf& ramp, float place, bool is_grey) {
  if (std::isnan(place)) return kSkyColor;
  if (is_grey) return {place, place, place};
  std::array<float, 3> color{};
  ramp.getpixel(int(std::lround(place * float(ramp.spec().width - 1))), 0, color.data(), 3);
  // OpenImageIO's ramps are linear light.
  for (float& c : color) c = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return color;
}

/// Makes the colour ramp, one row.
OIIO::ImageBuf make_ramp() {
  OIIO::ImageBuf places(OIIO::ImageSpec(256, 1, 1, OIIO::TypeFloat));
  for (int x = 0; x < 256; x++) {
    const float place = float(x) / 255;
    places.setpixel(x, 0, &place, 1);
  }
  return OIIO::ImageBufAlgo::color_map(places, 0, "viridis");
}

/// A chart being drawn: the picture, and below it the legend.
class Drawing {
 public:
  Drawing(const std::string& name, const Chart& chart)
      : name_(name),
        chart_(chart),
        zoom_(std::min((kLeastWidth + chart.width - 1) / chart.width, kLargestPixel)),
        width_(std::max(zoom_ * chart.width, kLeastWidth)),
        top_(zoom_ * chart.height),
        picture_(OIIO::ImageSpec(width_, top_ + kLegend, 3, OIIO::TypeFloat), OIIO::InitializePixels::Yes) {}

  void draw_picture() {
    for (int y = 0; y < top_; y++)
      for (int x = 0; x < zoom_ * chart_.width; x++) {
        const std::size_t at = std::size_t(y / zoom_) * std::size_t(chart_.width) + std::size_t(x / zoom_);
        picture_.setpixel(x, y, color_at(ramp_, chart_.places[at], chart_.is_grey).data(), 3);
      }
  }

  /// Draws the title, and below it the lowest number, the strip of colours, the highest number, and the colour of sky.
  void draw_legend() {
    const int strip = top_ + kLegend - kStripHeight - kMargin;
    const int base = strip + kStripHeight - 2;
    const int right = kTextWidth + kStrip + kMargin;
    const int sky = right + kTextWidth;
    for (int x = 0; x < kStrip; x++)
      fill(kTextWidth + x, strip, 1, color_at(ramp_, float(x) / float(kStrip - 1), chart_.is_grey));
    write(kMargin, top_ + kTitleBase, chart_.title);
    write(kMargin, base, chart_.low);
    write(right, base, chart_.high);
    fill(sky, strip, kStripHeight, kSkyColor);
    write(sky + kStripHeight + kMargin, base, "sky");
  }

  std::vector<char> encoded() const {
    std::vector<float> pixels(std::size_t(width_) * std::size_t(top_ + kLegend) * 3);
    picture_.get_pixels(picture_.roi(), OIIO::TypeFloat, pixels.data());
    return encode_png(name_, width_, top_ + kLegend, 3, pixels, chart_.made_by);
  }

 private:
  /// Fills a rectangle as high as the strip.
  void fill(int x, int y, int width, std::array<float, 3> color) {
    OIIO::ImageBufAlgo::fill(picture_, OIIO::cspan<float>(color.data(), 3),
                             OIIO::ROI(x, x + width, y, y + kStripHeight));
  }

  void write(int x, int base, const std::string& text) {
    if (!OIIO::ImageBufAlgo::render_text(picture_, x, base, text, kTextHeight, "DejaVuSans",
                                         {kTextGrey, kTextGrey, kTextGrey}))
      fail(ErrorKind::output, "{}: its texts need the font DejaVu Sans (Debian package fonts-dejavu-core): {}", name_,
           first_line(picture_.geterror()));
  }

  const std::string& name_;
  const Chart& chart_;
  int zoom_, width_, top_;  // px
  OIIO::ImageBuf picture_, ramp_ = make_ramp();
};

std::vector<char> draw_chart(const std::string& name, const Chart& chart) {
  Drawing drawing(name, chart);
  drawing.draw_picture();
  drawing.draw_legend();
  return drawing.encoded();
}

}  // namespace

extern "C" __attribute__((visibility("default")))
const ImageIoModule alcove_image_io_module = {open_by_oiio, draw_chart};

}  // namespace alcove
