// Tests of points that no camera sees: for cut components, stretched axes, and lenses that bend lines.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/position_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/base/ranks.h"
#include "core/frame/camera/least_squares.h"

namespace alcove {
namespace {

struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  double size() const { return most - least; }
};

std::array<Range, 3> ranges_of(std::span<const SeenPoint> points) {
  std::array<Range, 3> ranges;
  for (const auto& seen : points)
    for (std::size_t k = 0; k < 3; k++) {
      ranges[k].least = std::min(ranges[k].least, seen.position[k]);
      ranges[k].most = std::max(ranges[k].most, seen.position[k]);
    }
  return ranges;
}

// Components that were cut.

/// The components of a point that lie exactly at one end of what the points have.
std::size_t components_at(const SeenPoint& seen, double end) {
  return std::size_t(std::ranges::count(seen.position, end));
}

double share_where(std::span<const SeenPoint> points, const std::function<bool(const SeenPoint&)>& is) {
  return double(std::ranges::count_if(points, is)) / double(points.size());
}

/// Whether the points without any component at `end` are seen by a camera, as all others would be.
bool rest_is_seen(std::span<const SeenPoint> points, double end, const Window& display) {
  std::vector<SeenPoint> rest;
  std::ranges::copy_if(points, std::back_inserter(rest),
                       [&](const SeenPoint& seen) { return components_at(seen, end) == 0; });
  return rest.size() < points.size() && std::holds_alternative<Resection>(resection_of(rest, display));
}

/// Whether all points lie on one side of `end` and many at it. A floor at 0 does so too, with one component alone.
bool is_cut_at(std::span<const SeenPoint> points, double end, const Window& display) {
  constexpr double kMany = 0.05;
  const auto ranges = ranges_of(points);
  const bool is_end = std::ranges::all_of(ranges, [&](const Range& r) { return r.least >= end; }) ||
                      std::ranges::all_of(ranges, [&](const Range& r) { return r.most <= end; });
  if (!is_end || share_where(points, [&](const SeenPoint& s) { return components_at(s, end) > 0; }) < kMany)
    return false;
  return std::ranges::any_of(ranges, [&](const Range& r) { return r.least == end && r.most == end; }) ||
         share_where(points, [&](const SeenPoint& s) { return components_at(s, end) > 1; }) >= kMany ||
         rest_is_seen(points, end, display);
}

// Axes that were stretched.

/// Names the box that the points fill, which a program has normalized: of 0 to 1, or of the same range on each axis.
/// "" for any other.
std::string box_of(std::span<const SeenPoint> points) {
  constexpr double kAlike = 0.1, kFilled = 0.5, kRounded = 1e-3;
  const auto ranges = ranges_of(points);
  const bool is_unit = std::ranges::all_of(ranges, [](const Range& range) {
    return range.least >= -kRounded && range.most <= 1 + kRounded && range.size() >= kFilled;
  });
  if (is_unit) return ", all three from 0 to 1, as in a normalized bounding box";
  const bool is_alike = std::ranges::all_of(ranges, [&](const Range& range) {
    return std::max(std::abs(range.least - ranges[0].least), std::abs(range.most - ranges[0].most)) <
           kAlike * ranges[0].size();
  });
  if (!is_alike) return "";
  return fmt::format(", all three from {:.2g} to {:.2g}, as in a normalized bounding box", ranges[0].least,
                     ranges[0].most);
}

// Points along a projection.

double row_at(const double* row, const Vector3& p) { return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]; }

/// A projection of points: N numbers, equations that are linear in them, and the distance from a point to its pixel.
template <std::size_t N>
struct PointModel {
  void (*add)(const SeenPoint& seen, Square<N>& sums);
  double (*distance)(const Row<N>& numbers, const SeenPoint& seen);  // in units of `seen`
};

void add_linear(const SeenPoint& seen, Square<12>& sums) {
  const auto& [x, y, z] = seen.position;
  const double u = seen.x, v = seen.y;
  add_products(sums, {x, y, z, 1, 0, 0, 0, 0, -u * x, -u * y, -u * z, -u});
  add_products(sums, {0, 0, 0, 0, x, y, z, 1, -v * x, -v * y, -v * z, -v});
}

double linear_distance(const Row<12>& m, const SeenPoint& seen) {
  const double over = 1 / row_at(&m[8], seen.position);
  return std::hypot(row_at(&m[0], seen.position) * over - seen.x, row_at(&m[4], seen.position) * over - seen.y);
}

/// Any linear map to the picture's plane, so that axes may be stretched and skewed.
constexpr PointModel<12> kLinear{add_linear, linear_distance};

void add_round(const SeenPoint& seen, Square<8>& sums) {
  const auto& [x, y, z] = seen.position;
  const double u = seen.x, v = seen.y;
  add_products(sums, {v * x, v * y, v * z, v, -u * x, -u * y, -u * z, -u});
}

/// The distance across the direction from the middle.
double round_distance(const Row<8>& m, const SeenPoint& seen) {
  const double right = row_at(&m[0], seen.position), down = row_at(&m[4], seen.position);
  const double across = length(Vector3{seen.x, seen.y, 0}) / std::hypot(right, down);
  return std::hypot(std::abs(right) * across - std::abs(seen.x), std::abs(down) * across - std::abs(seen.y));
}

/// Any lens that is round: Tsai's radial alignment (A versatile camera calibration technique, 1987).
constexpr PointModel<8> kRound{add_round, round_distance};

/// The share of the points that the projection which fits best sees within kSeenWithin of their pixels.
template <std::size_t N>
double share_on(const PointModel<N>& model, std::span<const SeenPoint> points, const Window& display) {
  const double size = 0.5 * std::max(display.width, display.height);
  std::vector<SeenPoint> all = normalized(points).points;
  for (auto& seen : all) {
    seen.x = (seen.x - 0.5 * display.width) / size;
    seen.y = (seen.y - 0.5 * display.height) / size;
  }
  std::vector<double> distances(all.size(), 0);
  for (int turn = 0; turn < 4; turn++) {  // again without the points that are farthest off, as those of edges are
    const double most = 3 * median_of(distances);
    Square<N> sums{};
    for (std::size_t i = 0; i < all.size(); i++)
      if (turn == 0 || distances[i] <= most) model.add(all[i], sums);
    const Row<N> numbers = least_squares(sums);
    for (std::size_t i = 0; i < all.size(); i++) distances[i] = model.distance(numbers, all[i]);
  }
  std::size_t near = 0;
  for (std::size_t i = 0; i < all.size(); i++) near += distances[i] * size <= kSeenWithin + all[i].rounding;
  return double(near) / double(all.size());
}

/// Whether the points lie in one plane, or nearly so: then many projections see them alike.
bool are_in_plane(std::span<const SeenPoint> points) {
  constexpr double kFlat = 5e-7;  // of the sum of squared extents
  Square<3> sums{};
  Vector3 mean{};
  const std::vector<SeenPoint> all = normalized(points).points;
  for (const auto& seen : all)
    for (std::size_t i = 0; i < 3; i++) mean[i] += seen.position[i] / double(all.size());
  for (const auto& seen : all) add_products(sums, difference(seen.position, mean));
  const Vector3 across = least_squares(sums);
  return !(dot(across, times(sums, across)) > kFlat * (sums[0][0] + sums[1][1] + sums[2][2]));
}

}  // namespace

std::string why_cut(std::span<const SeenPoint> points, const Window& display) {
  if (points.size() < kLeastPoints) return "";
  if (is_cut_at(points, 0, display))
    return "they were cut at 0: no component is negative, and many are exactly 0, as in a format without sign; write "
           "them as float, or map them beforehand";
  if (is_cut_at(points, 1, display))
    return "they were cut at 1: no component is above 1, and many are exactly 1, as in an integer format; write them "
           "as float";
  return "";
}

std::string why_stretched(std::span<const SeenPoint> points, const Window& display, const Resection* camera,
                          double pixel_aspect) {
  constexpr double kSame = 0.02;
  if (points.size() < kLeastPoints || are_in_plane(points)) return "";
  const double aspect = camera ? camera->camera.fy / camera->camera.fx : 0;
  if (camera ? std::abs(aspect / pixel_aspect - 1) < kSame : share_on(kLinear, points, display) < kNearlyAll) return "";
  const std::string box = box_of(points);
  if (camera && box.empty()) return "";
  return fmt::format("they are stretched along their axes{}{}: write them in scene units", box,
                     camera ? fmt::format(" (so read, a pixel would be {:.3g} times as wide as high)", aspect) : "");
}

std::string why_bent(std::span<const SeenPoint> points, const Window& display) {
  if (points.size() < kLeastPoints || are_in_plane(points) || share_on(kRound, points, display) < kNearlyAll) return "";
  return "each lies in the right direction from the picture's middle, but at another distance: the lens is distorted, "
         "or a fish eye; render without distortion, or give a camera without it (a fish eye cannot be read)";
}

}  // namespace alcove
