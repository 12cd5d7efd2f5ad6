// A radius from how far away things are and how much of them the picture shows, and the notes on one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/radius.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

constexpr double kOfDistance = 0.1;            // of the median depth: a chair in a room, a stair of a house
constexpr double kOfWidth = 0.1;               // of what an orthographic camera sees, since its distance says nothing
constexpr double kMostOfWidth = 0.25;          // of what is seen at the median depth, which is little by a long lens
constexpr double kLeast = 1e-30, kMost = 1e9;  // scene units
constexpr double kFullPrecision = 0x1p-16;     // of the depth: no file of floats is worse
constexpr double kMostBelowPixel = 0.5;        // share of the surfaces

}  // namespace

std::optional<double> median_depth(const Reading& reading, std::span<const float> raw) {
  constexpr std::size_t kSampled = 1 << 15;  // pixels: a median of so many is good to less than a percent
  const View view = view_of(reading.camera, reading.data, reading.display);
  const DepthMap map = depth_map_of(reading);
  std::vector<double> depths;
  for_each_sampled(view, raw, reading.data, reading.data, kSampled, [&](const SampledPixel& pixel) {
    const double z = planar_depth(map, pixel.values, pixel.ray);
    if (std::isfinite(z)) depths.push_back(z);
  });
  return depths.empty() ? std::nullopt : std::optional(median_of(std::move(depths)));
}

std::optional<double> proposed_radius(const Camera& camera, std::optional<double> median_depth) {
  if (!median_depth) return std::nullopt;
  const double width = camera.width / camera.fx * (camera.orthographic ? 1 : *median_depth);
  const double radius =
      camera.orthographic ? kOfWidth * width : std::min(kOfDistance * *median_depth, kMostOfWidth * width);
  if (!(radius > kLeast && radius < kMost)) return std::nullopt;
  return number_of(fmt::format("{:.1g}", radius));
}

std::vector<double> radii_by_depth(const EstimatorSettings& settings, const Camera& camera,
                                   std::optional<double> median_depth) {
  if (settings.radius_auto) {
    const auto proposed = proposed_radius(camera, median_depth);
    return proposed ? std::vector{*proposed} : std::vector<double>();
  }
  if (!median_depth) return {};
  std::vector<double> radii{*settings.radius};
  radii.insert(radii.end(), settings.further_radii.begin(), settings.further_radii.end());
  for (double& radius : radii) radius = number_of(fmt::format("{:.4g}", radius * *median_depth)).value();
  return radii;
}

void DepthSample::add(const View& view, const DepthMap& map, const DepthPrecision& precision,
                      std::span<const float> raw) {
  const Window window{0, 0, view.size.x, view.size.y};
  add(view, map, precision, raw, window, window);
}

void DepthSample::add(const View& view, const DepthMap& map, const DepthPrecision& precision,
                      std::span<const float> raw, const Window& window, const Window& whole) {
  constexpr std::size_t kSampled = 4096;  // pixels of the whole
  view_ = view;
  precision_ = precision;
  for_each_sampled(view, raw, window, whole, kSampled, [&](const SampledPixel& pixel) {
    const double z = planar_depth(map, pixel.values, pixel.ray);
    if (std::isfinite(z)) depths_.emplace(pixel.number, z);
  });
}

/// The width of a pixel at a depth, in scene units.
double DepthSample::pixel_at(double depth) const {
  return (view_.orthographic ? 1 : depth) * double(view_.tangent_per_pixel.x);
}

double DepthSample::farthest() const {
  double farthest = 0;
  for (const auto& [pixel, depth] : depths_) farthest = std::max(farthest, depth);
  return farthest;
}

Notes DepthSample::notes(double smallest_radius, double largest_radius, int width, int height) const {
  Notes notes;
  if (depths_.empty()) return notes;
  std::vector<double> depths;
  for (const auto& [pixel, depth] : depths_) depths.push_back(depth);
  const double z = median_of(depths);
  const double precision = precision_.at_depth(z);
  if (smallest_radius < kLeastPrecisions * precision)
    notes.push_back(
        {NoteCode::radius_below_precision,
         fmt::format("radius {:.6g} is {:.2g} times the depth's precision of {:.2g} at the median depth {:.3g}{}: "
                     "occluders are lost in its rounding; give a larger --radius{}",
                     smallest_radius, smallest_radius / precision, precision, z,
                     precision > kFullPrecision * z ? "" : ", to which renderers compute it (floats step by less)",
                     precision > kFullPrecision * z ? ", or write depth with more bits" : "")});

  const auto is_below = [&](double depth) { return smallest_radius < pixel_at(depth); };
  const double below = double(std::ranges::count_if(depths, is_below)) / double(depths.size());
  if (below > kMostBelowPixel)
    notes.push_back(
        {NoteCode::radius_below_pixel,
         fmt::format(
             "radius {:.6g} is less than a pixel over {:.0f} % of the surfaces, where nothing can block: give a "
             "larger --radius",
             smallest_radius, 100 * below)});

  if (largest_radius > pixel_at(z) * std::max(width, height))
    notes.push_back({NoteCode::radius_beyond_picture,
                     fmt::format("radius {:.6g} is {:.6g} pixels at the median depth {:.3g}, and the picture is {}x{}: "
                                 "most of its reach lies outside the picture; give a smaller --radius",
                                 largest_radius, largest_radius / pixel_at(z), z, width, height)});
  return notes;
}

}  // namespace alcove
