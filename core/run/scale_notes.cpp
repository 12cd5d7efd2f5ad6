// Median depth against precision, pixel and picture.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/scale_notes.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/base/estimator_facts.h"

namespace alcove {
namespace {

constexpr std::size_t kSampled = 4096;      // pixels of a window
constexpr double kFullPrecision = 0x1p-16;  // of the depth: no file of floats is worse

}  // namespace

void DepthSample::add(const FrameInputs& inputs) {
  view_ = inputs.view;
  precision_ = inputs.depth_precision;
  const std::size_t pixels = std::size_t(view_.size.x) * std::size_t(view_.size.y), step = pixels / kSampled + 1;
  const auto raw = inputs[RawPlane::depth]->as<float>();
  for (std::size_t i = step / 2; i < pixels; i += step) {
    std::array<double, 3> values{};
    for (std::size_t axis = 0; axis < 3 && i + axis * pixels < raw.size(); axis++)
      values[axis] = raw[i + axis * pixels];
    const double x = (double(i % std::size_t(view_.size.x)) + 0.5 - view_.center.x) * view_.tangent_per_pixel.x;
    const double y = (double(i / std::size_t(view_.size.x)) + 0.5 - view_.center.y) * view_.tangent_per_pixel.y;
    const double z = planar_depth(inputs.depth_map, values, view_.orthographic ? 1 : std::sqrt(1 + x * x + y * y));
    if (std::isfinite(z)) depths_.push_back(z);
  }
}

std::vector<std::string> DepthSample::notes(const EstimatorSettings& settings, int width, int height) const {
  std::vector<std::string> said;
  if (depths_.empty()) return said;
  std::vector<double> depths = depths_;
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::ranges::nth_element(depths, middle);
  const double z = *middle, precision = precision_.at[0] + z * (precision_.at[1] + z * precision_.at[2]);
  const auto pixel_at = [&](double depth) {
    return (view_.orthographic ? 1 : depth) * double(view_.tangent_per_pixel.x);
  };
  const double least = radii_of(settings).front(), most = radii_of(settings).back();
  if (least < kLeastPrecisions * precision)
    said.push_back(
        fmt::format("radius {:.3g} is {:.2g} times the depth's precision of {:.2g} at the median depth {:.3g}: "
                    "occluders are lost in its rounding; "
                    "give a larger --radius{}",
                    least, least / precision, precision, z,
                    precision > kFullPrecision * z ? ", or write depth with more bits" : ""));
  const auto below = double(std::ranges::count_if(depths, [&](double depth) { return least < pixel_at(depth); })) /
                     double(depths.size());
  if (below > 0.5)
    said.push_back(
        fmt::format("radius {:.3g} is less than a pixel over {:.0f} % of the surfaces, where nothing can block: give a "
                    "larger --radius",
                    least, 100 * below));
  if (most > pixel_at(z) * std::max(width, height))
    said.push_back(
        fmt::format("radius {:.3g} is {:.3g} pixels at the median depth {:.3g}, and the picture is {}x{}: most of what "
                    "it reaches is not in it; "
                    "a smaller --radius needs no more than is seen",
                    most, most / pixel_at(z), z, width, height));
  return said;
}

}  // namespace alcove
