// Scales for the debug views; core/formats/image_io.cpp draws them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/formats/image_io.h"

namespace alcove {
namespace {

/// The part of the surfaces beyond either end of a percentile scale: so much may lie beyond a window without hiding the
/// room.
constexpr double kEnds = 0.03;

/// The number below which this part of them lies; they are put into another order.
float percentile(std::vector<float>& values, double part) {
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// The ends of the scale.
std::pair<float, float> range_of(const DebugView& view, std::span<const float> values) {
  if (view.scale == DebugScale::fixed || view.scale == DebugScale::fixed_logarithmic) return {view.low, view.high};
  std::vector<float> surfaces;
  std::ranges::copy_if(values, std::back_inserter(surfaces), [](float x) { return x < kSkyDepth; });
  if (surfaces.empty()) return {0, 1};
  return {percentile(surfaces, kEnds), percentile(surfaces, 1 - kEnds)};
}

/// Where each number stands on the scale, 0 to 1; sky is NaN.
std::vector<float> places_of(const DebugView& view, std::span<const float> values, float low, float high) {
  const bool logarithmic =
      view.scale == DebugScale::fixed_logarithmic || view.scale == DebugScale::percentile_logarithmic;
  const auto on_scale = [&](float x) {
    return logarithmic ? std::log(std::max(std::abs(x), std::numeric_limits<float>::min())) : x;
  };
  const float from = on_scale(low);
  const float range = on_scale(high) - from;
  std::vector<float> places(values.size());
  std::ranges::transform(values, places.begin(), [&](float x) {
    if (x >= kSkyDepth) return std::numeric_limits<float>::quiet_NaN();
    return range == 0 ? 0.5f : std::clamp((on_scale(x) - from) / range, 0.0f, 1.0f);
  });
  return places;
}

}  // namespace

void write_debug_view(const std::string& path, const DebugView& view, int width, int height,
                      std::span<const float> values, const std::string& made_by) {
  const auto [low, high] = range_of(view, values);
  const bool is_open = view.scale == DebugScale::percentile || view.scale == DebugScale::percentile_logarithmic;
  const auto text = [&](const char* beyond, float x) { return fmt::format("{}{:.4g}", is_open ? beyond : "", x); };
  const Chart chart{width,      height,           places_of(view, values, low, high),
                    view.title, text("<= ", low), text(">= ", high),
                    made_by,    view.is_grey};
  write_whole(path, encode_chart(path, chart));
}

}  // namespace alcove
