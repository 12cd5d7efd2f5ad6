// Direct linear transforms of samples, and least squares over what fits the best of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/resection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "core/base/ranks.h"

namespace alcove {
namespace {

/// A camera as it is solved: x right, y down, z forward, in a space where the points are about 1 in size.
struct Pinhole {
  bool orthographic = false;
  double fx = 1, fy = 1, cx = 0, cy = 0;
  std::array<Vector3, 3> axes{};  // rows
  Vector3 offset{};

  Vector3 in_view(const Vector3& p) const { return sum(times(axes, p), offset); }
};

/// A view point's distance from its pixel.
std::array<double, 2> error_of(const Pinhole& camera, const Vector3& view, const SeenPoint& seen) {
  const double over = camera.orthographic ? 1 : 1 / view[2];
  return {camera.cx + camera.fx * view[0] * over - seen.x, camera.cy + camera.fy * view[1] * over - seen.y};
}

double distance_of(const Pinhole& camera, const SeenPoint& seen) {
  const Vector3 view = camera.in_view(seen.position);
  if (!camera.orthographic && !(view[2] > 0)) return std::numeric_limits<double>::infinity();
  const auto [x, y] = error_of(camera, view, seen);
  const double distance = std::hypot(x, y);
  return std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance;
}

double median_distance(const Pinhole& camera, std::span<const SeenPoint> points) {
  std::vector<double> distances;
  for (const auto& point : points) distances.push_back(distance_of(camera, point));
  return median_of(std::move(distances));
}

using Picked = std::vector<const SeenPoint*>;

/// The places of the pixels, moved and scaled to be about 1 in size too.
struct ImageScale {
  double x, y, size;
};

/// The rows of the projection that maps points to pixels up to a factor, with a last row (0, 0, 0, 1) if orthographic.
using Projection = std::array<Row<4>, 3>;

std::optional<Projection> perspective_of(const Picked& points, const ImageScale& image) {
  Square<12> sums{};
  for (const auto* seen : points)
    add_linear({seen->position, (seen->x - image.x) / image.size, (seen->y - image.y) / image.size}, sums);
  const Row<12> fit = least_squares(sums);
  Projection projection{};
  for (std::size_t i = 0; i < 12; i++) projection[i / 4][i % 4] = fit[i];
  for (std::size_t k = 0; k < 4; k++) {
    projection[0][k] = projection[0][k] * image.size + projection[2][k] * image.x;
    projection[1][k] = projection[1][k] * image.size + projection[2][k] * image.y;
  }
  return projection;
}

std::optional<Projection> orthographic_of(const Picked& points, const ImageScale& image) {
  Square<4> sums{};
  Row<4> of_x{}, of_y{};
  for (const auto* seen : points) {
    const Row<4> p{seen->position[0], seen->position[1], seen->position[2], 1};
    for (std::size_t i = 0; i < 4; i++) {
      of_x[i] += p[i] * (seen->x - image.x);
      of_y[i] += p[i] * (seen->y - image.y);
    }
    add_products(sums, p);
  }
  const auto inverse = inverse_of(sums);
  if (!inverse) return std::nullopt;
  Projection projection{applied(*inverse, of_x), applied(*inverse, of_y), {0, 0, 0, 1}};
  projection[0][3] += image.x;
  projection[1][3] += image.y;
  return projection;
}

Vector3 first_three(const Row<4>& row) { return {row[0], row[1], row[2]}; }

/// Takes focal lengths and axes from rows of a projection, without its skew.
void take_axes(Pinhole& camera, const Vector3& x, const Vector3& y) {
  camera.fy = length(y);
  camera.axes[1] = scaled(y, 1 / camera.fy);
  const Vector3 right = difference(x, scaled(camera.axes[1], dot(x, camera.axes[1])));
  camera.fx = length(right);
  camera.axes[0] = scaled(right, 1 / camera.fx);
}

/// Takes a perspective projection apart. The points are in front.
std::optional<Pinhole> pinhole_of_perspective(Projection m, const Picked& points) {
  const double size = length(first_three(m[2]));
  if (!(size > 0)) return std::nullopt;
  std::size_t behind = 0;
  for (const auto* seen : points) behind += dot(first_three(m[2]), seen->position) + m[2][3] < 0;
  for (auto& row : m)
    for (auto& x : row) x *= (2 * behind > points.size() ? -1 : 1) / size;
  Pinhole camera;
  const Vector3 ahead = first_three(m[2]), x = first_three(m[0]), y = first_three(m[1]);
  camera.cx = dot(x, ahead);
  camera.cy = dot(y, ahead);
  take_axes(camera, difference(x, scaled(ahead, camera.cx)), difference(y, scaled(ahead, camera.cy)));
  camera.axes[2] = ahead;
  camera.offset = {(m[0][3] - camera.cx * m[2][3]) / camera.fx, (m[1][3] - camera.cy * m[2][3]) / camera.fy, m[2][3]};
  return camera;
}

/// The same of an orthographic one. It looks along the axis that makes the space right-handed; nothing tells how far
/// away it is, so the principal point is where the picture's middle is and the points are in front.
std::optional<Pinhole> pinhole_of_orthographic(const Projection& m, const Window& display) {
  Pinhole camera;
  camera.orthographic = true;
  take_axes(camera, first_three(m[0]), first_three(m[1]));
  if (!(camera.fx > 0)) return std::nullopt;  // also where fy is 0, since fx is NaN then
  camera.axes[2] = cross(camera.axes[0], camera.axes[1]);
  camera.cx = 0.5 * display.width;
  camera.cy = 0.5 * display.height;
  camera.offset = {(m[0][3] - camera.cx) / camera.fx, (m[1][3] - camera.cy) / camera.fy, 0};
  return camera;
}

constexpr std::size_t kUnknowns = 10;  // fx, fy, cx, cy, a turn, an offset
using Gradient = Row<kUnknowns>;

/// The derivatives of a point's place in the picture by the unknowns, in x and in y. Those that an orthographic view
/// does not depend on are 0.
std::array<Gradient, 2> gradients_of(const Pinhole& camera, const Vector3& view) {
  const double over = camera.orthographic ? 1 : 1 / view[2];
  const Vector3 turned = difference(view, camera.offset);
  std::array<Gradient, 2> gradients{};
  for (std::size_t c = 0; c < 2; c++) {
    Gradient& g = gradients[c];
    const double focal = c == 0 ? camera.fx : camera.fy;
    const double by_own = focal * over, by_depth = camera.orthographic ? 0 : -focal * view[c] * over * over;
    g[c] = view[c] * over;
    g[2 + c] = camera.orthographic ? 0 : 1;
    // A turn moves a point by its cross product with it.
    const std::array<Vector3, 2> own{Vector3{0, turned[2], -turned[1]}, Vector3{-turned[2], 0, turned[0]}};
    const Vector3 depth{turned[1], -turned[0], 0};
    for (std::size_t k = 0; k < 3; k++) g[4 + k] = by_own * own[c][k] + by_depth * depth[k];
    g[7 + c] = by_own;
    g[9] = by_depth;
  }
  return gradients;
}

/// Sums of products of the gradients over points; 1 in the diagonal for what nothing depends on.
Square<kUnknowns> products_of(const Pinhole& camera, const Picked& points, Gradient& toward) {
  Square<kUnknowns> sums{};
  toward = {};
  for (const auto* seen : points) {
    const Vector3 view = camera.in_view(seen->position);
    const auto error = error_of(camera, view, *seen);
    const auto gradients = gradients_of(camera, view);
    for (std::size_t c = 0; c < 2; c++) {
      for (std::size_t i = 0; i < kUnknowns; i++) toward[i] -= gradients[c][i] * error[c];
      add_products(sums, gradients[c]);
    }
  }
  for (std::size_t i = 0; i < kUnknowns; i++)
    if (sums[i][i] == 0) sums[i][i] = 1;
  return sums;
}

void make_unit_and_square(std::array<Vector3, 3>& axes) {
  const double handed = dot(cross(axes[0], axes[1]), axes[2]) < 0 ? -1 : 1;
  axes[0] = scaled(axes[0], 1 / length(axes[0]));
  axes[1] = difference(axes[1], scaled(axes[0], dot(axes[0], axes[1])));
  axes[1] = scaled(axes[1], 1 / length(axes[1]));
  axes[2] = scaled(cross(axes[0], axes[1]), handed);
}

Pinhole moved(Pinhole camera, const Gradient& by) {
  camera.fx += by[0];
  camera.fy += by[1];
  camera.cx += by[2];
  camera.cy += by[3];
  const Vector3 turn{by[4], by[5], by[6]};
  std::array<Vector3, 3> axes = camera.axes;
  for (std::size_t column = 0; column < 3; column++) {
    const Vector3 step = cross(turn, {camera.axes[0][column], camera.axes[1][column], camera.axes[2][column]});
    for (std::size_t row = 0; row < 3; row++) axes[row][column] += step[row];
  }
  make_unit_and_square(axes);
  camera.axes = axes;
  for (std::size_t k = 0; k < 3; k++) camera.offset[k] += by[7 + k];
  return camera;
}

double sum_of_squares(const Pinhole& camera, const Picked& points) {
  double sum = 0;
  for (const auto* seen : points) {
    const double distance = distance_of(camera, *seen);
    sum += distance * distance;
  }
  return sum;
}

/// Least squares, by Gauss and Newton.
Pinhole refined(Pinhole camera, const Picked& points) {
  constexpr int kSteps = 12;
  double sum = sum_of_squares(camera, points);
  for (int step = 0; step < kSteps; step++) {
    Gradient toward;
    const auto inverse = inverse_of(products_of(camera, points, toward));
    if (!inverse) break;
    const Pinhole next = moved(camera, applied(*inverse, toward));
    const double next_sum = sum_of_squares(next, points);
    if (!(next_sum < sum)) break;
    camera = next;
    sum = next_sum;
  }
  return camera;
}

bool is_near(const Pinhole& camera, const SeenPoint& seen, double within) {
  return distance_of(camera, seen) <= within + seen.rounding;
}

double share_within(const Pinhole& camera, std::span<const SeenPoint> points) {
  const auto count =
      std::ranges::count_if(points, [&](const SeenPoint& seen) { return is_near(camera, seen, kSeenWithin); });
  return double(count) / double(points.size());
}

/// The cost of a camera for points. Points far from their pixels count alike, however far (MSAC).
double cost_of(const Pinhole& camera, std::span<const SeenPoint> points) {
  constexpr double kFarOff = 5 * kSeenWithin;
  double cost = 0;
  for (const auto& seen : points) {
    const double off = std::min(distance_of(camera, seen) / (kFarOff + seen.rounding), 1.0);
    cost += off * off;
  }
  return cost;
}

/// The camera of one kind that sees most points where they are.
std::optional<Pinhole> solved(bool orthographic, std::span<const SeenPoint> points, const Window& display) {
  constexpr int kSamples = 50;
  constexpr std::size_t kOfSample = 14;
  const ImageScale image{0.5 * display.width, 0.5 * display.height, 0.5 * std::max(display.width, display.height)};
  const auto guess = [&](const Picked& picked) -> std::optional<Pinhole> {
    const auto projection = orthographic ? orthographic_of(picked, image) : perspective_of(picked, image);
    if (!projection) return std::nullopt;
    return orthographic ? pinhole_of_orthographic(*projection, display) : pinhole_of_perspective(*projection, picked);
  };
  Picked all;
  for (const auto& seen : points) all.push_back(&seen);
  std::optional<Pinhole> best = guess(all);
  double least = best ? cost_of(*best, points) : std::numeric_limits<double>::infinity();
  std::mt19937 random(1);  // the same frame has the same camera
  for (int i = 0; i < kSamples; i++) {
    Picked sample;
    std::ranges::sample(all, std::back_inserter(sample), kOfSample, random);
    const auto camera = guess(sample);
    const double cost = camera ? cost_of(*camera, points) : least;
    if (!(cost < least)) continue;
    least = cost;
    best = camera;
  }
  if (!best) return std::nullopt;
  for (const double times : {100, 20, 5, 2, 1, 1}) {
    const double within = times * kSeenWithin;
    Picked near;
    for (const auto& seen : points)
      if (is_near(*best, seen, within)) near.push_back(&seen);
    if (near.size() < kLeastPoints / 2) break;
    best = refined(*best, near);
  }
  return best;
}

/// The standard deviation of fx, relative to it, if points were as far off as half of them are, and a little at least.
double focal_error(const Pinhole& camera, std::span<const SeenPoint> points) {
  constexpr double kLittle = 0.01;  // px
  Picked near;
  for (const auto& seen : points)
    if (is_near(camera, seen, kSeenWithin)) near.push_back(&seen);
  Gradient toward;
  const auto inverse = inverse_of(products_of(camera, near, toward));
  const double variance = inverse ? (*inverse)[0][0] : -1;
  // Rounding may leave a singular matrix with any inverse.
  if (!(variance > 0)) return std::numeric_limits<double>::infinity();
  return std::max(median_distance(camera, points), kLittle) * std::sqrt(variance) / camera.fx;
}

/// The map from the world to view space, in scene units.
struct CameraPlace {
  Matrix3 view_from_world{};
  Vector3 offset{};
};

CameraPlace placement_of(const Pinhole& solved, const Normalized& from) {
  CameraPlace placed;
  for (std::size_t row = 0; row < 3; row++) {
    const double sign = row == 0 ? 1 : -1;  // up, and backwards
    placed.view_from_world[row] = scaled(solved.axes[row], sign);
    placed.offset[row] = sign * (from.size * solved.offset[row] - dot(solved.axes[row], from.middle));
  }
  return placed;
}

/// Whether the camera stands at the origin, turned or moved by very little, in radians and in what the scene measures.
bool is_at_origin(const CameraPlace& placed, bool orthographic, double size) {
  constexpr double kLittle = 1e-3;
  const double ahead = placed.view_from_world[2][2] < 0 ? -1 : 1;
  double apart = 0;
  for (std::size_t row = 0; row < 3; row++) {
    for (std::size_t column = 0; column < 3; column++)
      apart = std::max(apart, std::abs(placed.view_from_world[row][column] - (row != column ? 0
                                                                              : row == 2    ? ahead
                                                                                            : 1)));
    if (row < 2 || !orthographic) apart = std::max(apart, std::abs(placed.offset[row]) / size);
  }
  return apart < kLittle;
}

/// The nearest and the farthest of the points that fit, along the axis, from the world's origin.
std::pair<double, double> extent_of(const Pinhole& solved, const Normalized& from, const Vector3& back) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const auto& seen : from.points) {
    if (!is_near(solved, seen, kSeenWithin)) continue;
    const double z = -(dot(back, seen.position) * from.size + dot(back, from.middle));
    least = std::min(least, z);
    most = std::max(most, z);
  }
  return {least, most};
}

/// The solved camera in scene units, as Camera has it.
Resection result_of(const Pinhole& solved, const Normalized& from, const Window& display) {
  Resection result;
  result.within = share_within(solved, from.points);
  result.median = median_distance(solved, from.points);
  result.focal_error = focal_error(solved, from.points);
  Camera& camera = result.camera;
  camera.width = display.width;
  camera.height = display.height;
  camera.orthographic = solved.orthographic;
  const double per_unit = solved.orthographic ? 1 / from.size : 1;
  camera.fx = solved.fx * per_unit;
  camera.fy = solved.fy * per_unit;
  camera.cx = solved.cx;
  camera.cy = solved.cy;
  CameraPlace placed = placement_of(solved, from);
  const auto [nearest, farthest] = extent_of(solved, from, placed.view_from_world[2]);
  if (is_at_origin(placed, solved.orthographic, from.size) && (!solved.orthographic || nearest > 0)) {
    camera.left_handed = placed.view_from_world[2][2] < 0;
    return result;
  }
  // An orthographic view may be anywhere before what it sees.
  if (solved.orthographic) placed.offset[2] = nearest - 2 * (farthest - nearest) - from.size;
  camera.view_from_world = placed.view_from_world;
  camera.view_from_world_offset = placed.offset;
  camera.left_handed = determinant(placed.view_from_world) < 0;
  return result;
}

}  // namespace

void add_linear(const SeenPoint& seen, Square<12>& sums) {
  const auto& [x, y, z] = seen.position;
  const double u = seen.x, v = seen.y;
  add_products(sums, {x, y, z, 1, 0, 0, 0, 0, -u * x, -u * y, -u * z, -u});
  add_products(sums, {0, 0, 0, 0, x, y, z, 1, -v * x, -v * y, -v * z, -v});
}

Normalized normalized(std::span<const SeenPoint> points) {
  Normalized result{{points.begin(), points.end()}, {}, 1};
  for (std::size_t k = 0; k < 3; k++) {
    std::vector<double> values;
    for (const auto& seen : points) values.push_back(seen.position[k]);
    result.middle[k] = median_of(std::move(values));
  }
  std::vector<double> distances;
  for (const auto& seen : points) distances.push_back(length(difference(seen.position, result.middle)));
  if (const double median = median_of(std::move(distances)); median > 0) result.size = median;
  for (auto& seen : result.points) seen.position = scaled(difference(seen.position, result.middle), 1 / result.size);
  return result;
}

std::variant<Resection, NoResection> resection_of(std::span<const SeenPoint> points, const Window& display) {
  if (points.size() < kLeastPoints)
    return NoResection{fmt::format("only {} of them are on smooth surfaces", points.size())};
  constexpr double kLargestFocalError = 1e-3;
  const Normalized from = normalized(points);
  // Perspective views see all that orthographic ones do, from very far.
  constexpr double kAlike = 1.5, kExact = 1e-4;
  const auto flat = solved(true, from.points, display), deep = solved(false, from.points, display);
  const bool is_flat = flat && (!deep || cost_of(*flat, from.points) <=
                                             kAlike * cost_of(*deep, from.points) + kExact * double(points.size()));
  const auto& camera = is_flat ? flat : deep;
  const auto best = camera ? std::optional(result_of(*camera, from, display)) : std::nullopt;
  const double median = best ? best->median : std::numeric_limits<double>::infinity();
  if (!best || best->within < kNearlyAll)
    return NoResection{fmt::format("by the best camera {:.0f} % of them lie within {} px of their pixels, {:.2g} px in "
                                   "the median: no camera fits, so they are filtered, no positions, or a panorama's",
                                   best ? 100 * best->within : 0, kSeenWithin, median),
                       median};
  if (!(best->focal_error <= kLargestFocalError))
    return NoResection{"they lie in one plane, or nearly so, and many cameras fit"};
  return *best;
}

}  // namespace alcove
