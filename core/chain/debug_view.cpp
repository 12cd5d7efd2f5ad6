// Scales for the debug views; core/formats/image_io.cpp draws them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/debug_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/image_io.h"
#include "kernels/debug.h"

namespace alcove {
namespace {

constexpr std::array kViews{
    DebugView{"raw-depth", "raw depth: the channel as the file holds it", kDebugValue, DebugSource::raw_depth,
              DebugScale::percentile, 0, 0, false},
    DebugView{"linear-depth", "linear depth: distance along the optical axis, scene units", kDebugPlanarDepth,
              DebugSource::none, DebugScale::percentile, 0, 0, false},
    DebugView{"view-z", "view z: z in view space, scene units (logarithmic)", kDebugViewZ, DebugSource::none,
              DebugScale::percentile_logarithmic, 0, 0, false},
    DebugView{"view-normal-z", "view normal z: 1 faces along the optical axis", kDebugNormalZ, DebugSource::none,
              DebugScale::fixed, -1, 1, false},
    DebugView{"reconstruction", "reconstruction: degrees between the normals and those from depth; 30 and more are one",
              kDebugNormalAngle, DebugSource::normals_from_depth, DebugScale::fixed, 0, 30, false},
    DebugView{"raw-ao", "raw AO: as estimated, at its own resolution; 1 is open", kDebugValue, DebugSource::raw_ao,
              DebugScale::fixed, 0, 1, true},
    DebugView{"denoised-ao", "denoised AO: before upsampling and shaping; 1 is open", kDebugValue,
              DebugSource::denoised_ao, DebugScale::fixed, 0, 1, true},
    DebugView{
        "tiles",
        "tiles: share of the directions in which something may block; 0 is proved open, or as in the frame before",
        kDebugTile, DebugSource::tiles, DebugScale::fixed, 0, 1, false},
    DebugView{"edges", "edges: a neighbour's distance from the tangent plane, part of the depth (logarithmic)",
              kDebugEdge, DebugSource::none, DebugScale::fixed_logarithmic, 1e-4f, 1, false},
};

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
  const float from = on_scale(low), range = on_scale(high) - from;
  std::vector<float> places(values.size());
  std::ranges::transform(values, places.begin(), [&](float x) {
    if (x >= kSkyDepth) return std::numeric_limits<float>::quiet_NaN();
    return range == 0 ? 0.5f : std::clamp((on_scale(x) - from) / range, 0.0f, 1.0f);
  });
  return places;
}

}  // namespace

std::span<const DebugView> debug_view_table() { return kViews; }

std::vector<std::string> debug_view_names() {
  std::vector<std::string> names;
  std::ranges::transform(kViews, std::back_inserter(names), &DebugView::name);
  return names;
}

std::vector<const DebugView*> debug_views_of(const OutputSettings& settings) {
  std::vector<const DebugView*> views;
  if (settings.debug.empty()) return views;
  for (const auto& name : split(settings.debug)) {
    const auto found = std::ranges::find(kViews, name, &DebugView::name);
    if (found == kViews.end())
      fail(ErrorKind::usage, "--debug: there is no view \"{}\"{}; there is {}", name,
           suggestion(name, debug_view_names()), list_of(debug_view_names()));
    if (std::ranges::find(views, &*found) == views.end()) views.push_back(&*found);
  }
  return views;
}

std::string debug_path(const OutputSettings& settings, const DebugView& view) {
  const std::string& output = settings.output;
  return (output.ends_with(".exr") ? output.substr(0, output.size() - 4) : output) + "." + view.name + ".png";
}

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
