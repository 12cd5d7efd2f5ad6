// Puts numbers on a scale of colours, and frames into the display window.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/ranks.h"
#include "core/base/windows.h"
#include "core/chain/debug_view.h"
#include "core/formats/png.h"
#include "core/run/composite_window.h"

namespace alcove {
namespace {

/// The part of the surfaces beyond either end of a percentile scale. So much may lie beyond a window without hiding the
/// room.
constexpr double kEnds = 0.03;

/// The values at the two ends of the scale.
std::pair<float, float> range_of(const DebugView& view, std::span<const float> values) {
  if (view.scale == DebugScale::fixed || view.scale == DebugScale::fixed_logarithmic) return {view.low, view.high};
  std::vector<float> surfaces;
  std::ranges::copy_if(values, std::back_inserter(surfaces), [](float x) { return x < kSkyDepth; });
  if (surfaces.empty()) return {0, 1};
  const auto at = [&](double part) { return value_at_rank(surfaces, std::size_t(part * double(surfaces.size() - 1))); };
  return {at(kEnds), at(1 - kEnds)};
}

/// Where each number stands on the scale, 0 to 1; sky is NaN.
std::vector<float> places_of(const DebugView& view, std::span<const float> values, float low, float high) {
  const bool logarithmic =
      view.scale == DebugScale::fixed_logarithmic || view.scale == DebugScale::percentile_logarithmic;
  const auto on_scale = [&](float x) {
    return logarithmic ? std::log(std::max(std::abs(x), std::numeric_limits<float>::min())) : x;
  };
  const float from = on_scale(low), range = on_scale(high) - from;
  std::vector<float> places(values.size());
  std::ranges::transform(values, places.begin(), [&](float x) {
    if (x >= kSkyDepth) return std::numeric_limits<float>::quiet_NaN();
    return range == 0 ? 0.5f : std::clamp((on_scale(x) - from) / range, 0.0f, 1.0f);
  });
  return places;
}

/// A colour that brightens evenly from violet by green to yellow, display values: a polynomial of the sixth degree
/// through "viridis" of Smith and van der Walt, off by at most .03.
std::array<float, 3> color_at(float place) {
  constexpr std::array<std::array<float, 3>, 7> kPowers{{{0.277727f, 0.005407f, 0.334100f},
                                                         {0.105093f, 1.404614f, 1.384590f},
                                                         {-0.330862f, 0.214848f, 0.095095f},
                                                         {-4.634230f, -5.799101f, -19.332441f},
                                                         {6.228270f, 14.179933f, 56.690553f},
                                                         {4.776385f, -13.745145f, -65.353033f},
                                                         {-5.435456f, 4.645853f, 26.312435f}}};
  std::array<float, 3> color{};
  for (std::size_t c = 0; c < 3; c++)
    for (std::size_t power = kPowers.size(); power-- > 0;) color[c] = color[c] * place + kPowers[power][c];
  return color;
}

/// Writes the picture of one view, a pixel for each number. `values` holds one number per pixel, kSkyDepth for sky.
void write_debug_view(const std::string& path, const DebugView& view, int width, int height,
                      std::span<const float> values, const std::string& made_by) {
  const auto [low, high] = range_of(view, values);
  const bool is_open = view.scale == DebugScale::percentile || view.scale == DebugScale::percentile_logarithmic;
  const auto text = [&](const char* beyond, float x) { return fmt::format("{}{:.4g}", is_open ? beyond : "", x); };
  std::vector<float> pixels;
  pixels.reserve(3 * values.size());
  for (const float place : places_of(view, values, low, high)) {
    const auto color = std::isnan(place) ? kSkyColor : view.is_grey ? std::array{place, place, place} : color_at(place);
    pixels.insert(pixels.end(), color.begin(), color.end());
  }
  write_png(path, width, height, 3, pixels, made_by,
            fmt::format("{}. Darkest: {}, brightest: {}.", view.title, text("<= ", low), text(">= ", high)));
}

/// The display window of `planes` planes over a data window, interleaved; black where there are no pixels.
std::vector<float> displayed(const Window& display, const Window& data, std::span<const float> pixels, int planes) {
  std::vector<float> interleaved(display.pixels() * std::size_t(planes));
  for (int y = std::max(data.y, display.y); y < std::min(data.y + data.height, display.y + display.height); y++)
    for (int x = std::max(data.x, display.x); x < std::min(data.x + data.width, display.x + display.width); x++)
      for (int c = 0; c < planes; c++)
        interleaved[(std::size_t(y - display.y) * std::size_t(display.width) + std::size_t(x - display.x)) *
                        std::size_t(planes) +
                    std::size_t(c)] =
            pixels[std::size_t(c) * data.pixels() + std::size_t(y - data.y) * std::size_t(data.width) +
                   std::size_t(x - data.x)];
  return interleaved;
}

/// A plane over source.data as pixels of the picture.
std::vector<float> in_picture(const FrameSource& source, std::span<const float> plane) {
  return middle_pixels(plane, source.data, source.display, source.supersampling);
}

/// The composite over a window, band by band, since the beauty's rows may be far longer than those of the display.
/// Where nothing is computed it is the beauty.
std::vector<float> shown_composite(FrameSource& source, const gpu::Buffer* computed, const Window& shown) {
  constexpr int kBand = 64;  // rows; files compress no more together, but for a few
  std::vector<std::vector<float>> planes;
  const auto values = computed ? computed->as<const float>() : std::span<const float>();
  for (std::size_t at = 0; at < values.size(); at += source.data.pixels())
    planes.push_back(in_picture(source, values.subspan(at, source.data.pixels())));
  const Window from = computed ? picture_of(source, source.data) : Window{};
  const std::size_t count = source[RawPlane::beauty].size();
  std::vector<float> pixels(count * shown.pixels());
  for (int y = shown.y; y < shown.y + shown.height; y += kBand) {
    const Window band{shown.x, y, shown.width, std::min(kBand, shown.y + shown.height - y)};
    const auto composite =
        composite_over(source, count, band, from, std::vector<std::span<const float>>(planes.begin(), planes.end()));
    for (std::size_t c = 0; c < composite.size(); c++)
      copy_common(composite[c].data(), band, pixels.data() + c * shown.pixels(), shown);
  }
  return pixels;
}

/// Interleaved display values, over the picture's display window.
struct Shown {
  int width, planes;
  std::vector<float> pixels;
};

/// AO by itself is data, and shown as it is.
Shown shown_ao(const FrameSource& source, const gpu::Buffer& ao) {
  const Window display = picture_of(source, source.display), data = picture_of(source, source.data);
  const std::vector<float> pixels = in_picture(source, ao.as<float>());
  const Window written = written_picture(source);
  return {display.width, 1, displayed(display, written, cropped(pixels, data, written), 1)};
}

/// A beauty, or a composite, through the view transform.
Shown shown_colors(FrameSource& source, const gpu::Buffer* computed, const DisplayTransform* transform) {
  const Window display = picture_of(source, source.display);
  const Window data = common_part(composite_window(source), display);
  Shown shown{display.width, 3, displayed(display, data, shown_composite(source, computed, data), 3)};
  if (transform) transform->apply(shown.pixels);
  return shown;
}

/// Both side by side, with a grey line between.
Shown beside(const Shown& left, const Shown& right) {
  constexpr int kLine = 4;  // px
  constexpr float kGrey = 0.5F;
  Shown both{left.width + kLine + right.width, 3, {}};
  const auto of_row = [](const Shown& shown, std::size_t row) {
    const std::size_t values = 3 * std::size_t(shown.width);
    return std::span(shown.pixels).subspan(row * values, values);
  };
  const std::size_t rows = left.pixels.size() / (3 * std::size_t(left.width));
  for (std::size_t row = 0; row < rows; row++) {
    std::ranges::copy(of_row(left, row), std::back_inserter(both.pixels));
    both.pixels.insert(both.pixels.end(), 3 * kLine, kGrey);
    std::ranges::copy(of_row(right, row), std::back_inserter(both.pixels));
  }
  return both;
}

Shown preview_of(FrameSource& source, const FrameOutputs& outputs, const DisplayTransform* transform,
                 const std::string& style) {
  if (!outputs.composite || style == "ao") return shown_ao(source, *outputs.ao);
  const Shown composite = shown_colors(source, outputs.composite, transform);
  return style == "split" ? beside(shown_colors(source, nullptr, transform), composite) : composite;
}

}  // namespace

void write_pictures(FrameSource& source, const FrameOutputs& outputs, const DisplayTransform* transform,
                    const OutputSettings& settings, const Provenance& provenance) {
  const std::string text = made_by(provenance.options, provenance.inputs);
  for (const auto& plane : outputs.debug)
    write_debug_view(debug_path(settings, *plane.view), *plane.view, plane.size.x, plane.size.y,
                     plane.values->as<float>(), text);
  if (settings.preview.empty()) return;
  const Shown shown = preview_of(source, outputs, transform, settings.preview_style);
  const int height = int(shown.pixels.size()) / shown.planes / shown.width;
  write_png(settings.preview, shown.width, height, shown.planes, shown.pixels, text);
}

}  // namespace alcove
