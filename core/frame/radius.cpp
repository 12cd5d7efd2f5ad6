// A radius from how far away things are and how much of them the picture shows.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/radius.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/frame/depth.h"

namespace alcove {
namespace {

constexpr std::size_t kSampled = 1 << 15;      // pixels: a median of so many is good to less than a percent
constexpr double kOfDistance = 0.1;            // of the median depth: a chair in a room, a stair of a house
constexpr double kOfWidth = 0.1;               // of what an orthographic camera sees, since its distance says nothing
constexpr double kMostOfWidth = 0.25;          // of what is seen at the median depth, which is little by a long lens
constexpr double kLeast = 1e-30, kMost = 1e9;  // scene units

}  // namespace

std::optional<double> median_depth(const Reading& reading, std::span<const float> raw) {
  const View view = view_of(reading.camera, reading.data, reading.display);
  const DepthMap map = depth_map_of(reading);
  const std::size_t width = std::size_t(view.size.x), pixels = width * std::size_t(view.size.y);
  const std::size_t step = pixels / kSampled + 1;
  std::vector<double> depths;
  for (std::size_t i = step / 2; i < pixels; i += step) {
    std::array<double, 3> values{};
    for (std::size_t axis = 0; axis < 3 && i + axis * pixels < raw.size(); axis++)
      values[axis] = raw[i + axis * pixels];
    const double x = (double(i % width) + 0.5 - view.center.x) * view.tangent_per_pixel.x;
    const double y = (double(i / width) + 0.5 - view.center.y) * view.tangent_per_pixel.y;
    const double z = planar_depth(map, values, view.orthographic ? 1 : std::sqrt(1 + x * x + y * y));
    if (std::isfinite(z)) depths.push_back(z);
  }
  if (depths.empty()) return std::nullopt;
  return median_of(std::move(depths));
}

std::optional<double> proposed_radius(const Camera& camera, std::optional<double> median_depth) {
  if (!median_depth) return std::nullopt;
  const double width = camera.width / camera.fx * (camera.orthographic ? 1 : *median_depth);
  const double radius =
      camera.orthographic ? kOfWidth * width : std::min(kOfDistance * *median_depth, kMostOfWidth * width);
  if (!(radius > kLeast && radius < kMost)) return std::nullopt;
  return number_of(fmt::format("{:.1g}", radius));
}

}  // namespace alcove
