// Tries the rays of panoramas on points whose place in space and in the picture is known.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/resection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/ranks.h"
#include "core/frame/camera/least_squares.h"

namespace alcove {
namespace {

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

std::string panorama_of(std::span<const SeenPoint> points, const Window& display) {
  if (points.size() < kLeastPoints) return "";
  const Normalized from = normalized(points);
  for (const auto& panorama : kPanoramas)
    if (share_seen(panorama, from.points, display) >= kNearlyAll) return panorama.name;
  return "";
}

}  // namespace alcove
