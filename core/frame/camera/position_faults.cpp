// Tests of points that no camera sees: for cut components, stretched axes, lenses that bend lines, and panoramas.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/resection.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/ranks.h"

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

// Panoramas.

constexpr double kPi = std::numbers::pi;

/// A way from pixels to rays, of a camera that looks along -z. x and y are px from the picture's middle, y up.
struct Panorama {
  const char* name;
  Vector3 (*ray)(double x, double y, const Window& display);
};

Vector3 on_sphere(double x, double y, double per_px) {
  const double longitude = x * per_px, latitude = y * per_px;
  return {std::sin(longitude) * std::cos(latitude), std::sin(latitude), -std::cos(longitude) * std::cos(latitude)};
}

Vector3 on_cylinder(double x, double y, double per_px) {
  const double longitude = x * per_px, height = y * per_px, over = 1 / std::hypot(1, height);
  return {std::sin(longitude) * over, height * over, -std::cos(longitude) * over};
}

/// Angles from the axis grow with the distance from the middle. The circle of 180 degrees touches the shorter sides.
Vector3 in_fish_eye(double x, double y, const Window& display) {
  const double radius = std::hypot(x, y), angle = radius * kPi / std::min(display.width, display.height);
  const double over = radius > 0 ? std::sin(angle) / radius : 0;
  return {x * over, y * over, -std::cos(angle)};
}

/// The same with the area of the picture in proportion to the solid angle.
Vector3 in_equisolid_fish_eye(double x, double y, const Window& display) {
  const double radius = std::hypot(x, y), half = 0.5 * std::min(display.width, display.height);
  const double angle = 2 * std::asin(std::min(radius / half * std::sin(kPi / 4), 1.0));
  const double over = radius > 0 ? std::sin(angle) / radius : 0;
  return {x * over, y * over, -std::cos(angle)};
}

constexpr Panorama kPanoramas[] = {
    {"equirectangular, 360 degrees wide",
     [](double x, double y, const Window& d) { return on_sphere(x, y, 2 * kPi / d.width); }},
    {"equirectangular, 180 degrees wide",
     [](double x, double y, const Window& d) { return on_sphere(x, y, kPi / d.width); }},
    {"cylindrical, 360 degrees wide",
     [](double x, double y, const Window& d) { return on_cylinder(x, y, 2 * kPi / d.width); }},
    {"cylindrical, 180 degrees wide",
     [](double x, double y, const Window& d) { return on_cylinder(x, y, kPi / d.width); }},
    {"fish eye", in_fish_eye},
    {"fish eye", in_equisolid_fish_eye},
};

/// Rows of a map from space to the directions in which the camera sees it, up to their lengths.
using Map = std::array<Row<4>, 3>;

struct Ray {
  Vector3 direction;
  const SeenPoint* seen;
};

/// The direct linear transform: ray x (map point) = 0 for all points, as for a camera with a plane.
Map map_of(const std::vector<Ray>& rays) {
  Square<12> sums{};
  for (const auto& [d, seen] : rays) {
    const Row<4> p{seen->position[0], seen->position[1], seen->position[2], 1};
    const std::array<Vector3, 3> crossed{Vector3{0, -d[2], d[1]}, Vector3{d[2], 0, -d[0]}, Vector3{-d[1], d[0], 0}};
    for (const auto& row : crossed) {
      Row<12> equation{};
      for (std::size_t i = 0; i < 12; i++) equation[i] = row[i / 4] * p[i % 4];
      add_products(sums, equation);
    }
  }
  const Row<12> fit = least_squares(sums);
  Map map{};
  for (std::size_t i = 0; i < 12; i++) map[i / 4][i % 4] = fit[i];
  return map;
}

/// The angles between rays and the directions in which the map puts their points, radians. The map's sign is open.
std::vector<double> angles_of(const Map& map, const std::vector<Ray>& rays) {
  std::vector<double> angles, opposite;
  for (const auto& [direction, seen] : rays) {
    Vector3 to{};
    for (std::size_t row = 0; row < 3; row++)
      to[row] = map[row][0] * seen->position[0] + map[row][1] * seen->position[1] + map[row][2] * seen->position[2] +
                map[row][3];
    const double angle = std::atan2(length(cross(direction, to)), dot(direction, to));
    angles.push_back(angle);
    opposite.push_back(kPi - angle);
  }
  return median_of(angles) < kPi / 2 ? angles : opposite;
}

/// The share of the points that the best camera of this kind sees within a pixel.
double share_seen(const Panorama& panorama, std::span<const SeenPoint> points, const Window& display) {
  std::vector<Ray> rays;
  for (const auto& seen : points)
    rays.push_back({panorama.ray(seen.x - 0.5 * display.width, 0.5 * display.height - seen.y, display), &seen});
  const double pixel = kPi / std::max(display.width, display.height);
  std::vector<double> angles = angles_of(map_of(rays), rays);
  // Again without the points that are farthest off, as those of edges are.
  const double middle = median_of(angles);
  std::vector<Ray> near;
  for (std::size_t i = 0; i < rays.size(); i++)
    if (angles[i] <= 2 * middle) near.push_back(rays[i]);
  angles = angles_of(map_of(near), rays);
  return double(std::ranges::count_if(angles, [&](double angle) { return angle <= pixel; })) / double(points.size());
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

std::string panorama_of(std::span<const SeenPoint> points, const Window& display) {
  if (points.size() < kLeastPoints) return "";
  const Normalized from = normalized(points);
  for (const auto& panorama : kPanoramas)
    if (share_seen(panorama, from.points, display) >= kNearlyAll) return panorama.name;
  return "";
}

}  // namespace alcove
