// Statistics over pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/ranks.h"
#include "core/frame/samples.h"
#include "kernels/geometry/geometry.h"

namespace alcove {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void count_value(ValueStatistics& s, float x) {
  s.pixels++;
  if (std::isnan(x)) return void(s.nan++);
  if (std::isinf(x)) return void(s.infinite++);
  s.negative += x < 0;
  s.zero += x == 0;
  s.one += x == 1;
  s.positive += x > 0;
  s.least = std::min(s.least, double(x));
  s.most = std::max(s.most, double(x));
}

/// Counts a normal as it stands in the file, unless it is zero or not finite. Components beyond `components` are 0.
void count_normal(NormalStatistics& s, std::vector<double>& lengths, const Vector3& n, std::size_t components) {
  Vector3 unorm{};
  for (std::size_t c = 0; c < components; c++) unorm[c] = 2 * n[c] - 1;
  const double length = std::sqrt(dot(n, n));
  const double unorm_length = std::sqrt(dot(unorm, unorm));
  if (!(length > 0) || std::isinf(length)) return;
  s.count++;
  lengths.push_back(length);
  s.mean_length += length;
  s.unorm_mean_length += unorm_length;
  s.unit_share += std::abs(length - 1) < kUnitTolerance;
  s.unorm_unit_share += std::abs(unorm_length - 1) < kUnitTolerance;
  for (std::size_t c = 0; c < components; c++) {
    s.least = std::min(s.least, n[c]);
    s.most = std::max(s.most, n[c]);
  }
}

/// The distance, in pixels, from a pixel to the place where a point of view space is seen; infinite behind the camera.
double pixels_beside(const View& view, int x, int y, const Vector3& p) {
  if (!(-p[2] > 0)) return kInfinity;
  const Vector3 t = tangent_at(view, x, y);
  const double scale = view.orthographic ? 1 : -p[2];
  return std::hypot((p[0] / scale - t[0]) / view.tangent_per_pixel.x, (p[1] / scale - t[1]) / view.tangent_per_pixel.y);
}

}  // namespace

Vector3 decoded_normal(std::span<const float> raw, std::size_t pixels, std::size_t i, NormalEncoding encoding,
                       bool unorm) {
  Vector3 n{};
  for (std::size_t c = 0; c * pixels < raw.size(); c++)
    n[c] = unorm ? 2 * raw[c * pixels + i] - 1.0 : raw[c * pixels + i];
  const double squared = n[0] * n[0] + n[1] * n[1];
  if (encoding == NormalEncoding::octahedral) {
    n[2] = 1 - std::abs(n[0]) - std::abs(n[1]);
    if (n[2] < 0) n = {std::copysign(1 - std::abs(n[1]), n[0]), std::copysign(1 - std::abs(n[0]), n[1]), n[2]};
  } else if (encoding == NormalEncoding::spheremap) {
    const double across = 2 * std::sqrt(std::max(1 - squared, 0.0));
    n = squared <= 1 ? Vector3{across * n[0], across * n[1], 2 * squared - 1} : Vector3{};
  } else if (raw.size() < 3 * pixels) {
    n[2] = std::sqrt(std::max(1 - squared, 0.0));
  }
  return n;
}

ValueStatistics statistics_of(std::span<const float> values, std::size_t step) {
  ValueStatistics s;
  s.least = kInfinity;
  s.most = -kInfinity;
  for (std::size_t i = 0; i < values.size(); i += step) count_value(s, values[i]);
  if (s.least > s.most) s.least = s.most = 0;
  return s;
}

NormalStatistics normal_statistics(std::span<const float> normal, std::span<const float> raw, const DepthMap& map,
                                   std::size_t step) {
  NormalStatistics s;
  std::vector<double> lengths;
  s.least = kInfinity;
  s.most = -kInfinity;
  const std::size_t plane = map.form == kDepthPosition ? raw.size() / 3 : raw.size();
  const std::size_t components = normal.size() / plane;
  for (std::size_t i = 0; i < plane; i += step) {
    if (std::isinf(planar_depth(map, value_at(raw, plane, i), 1))) continue;
    Vector3 n{};
    for (std::size_t c = 0; c < components; c++) n[c] = normal[c * plane + i];
    count_normal(s, lengths, n, components);
  }
  if (!s.count) return {};
  s.usual_length = value_at_rank(lengths, lengths.size() / 2);
  const double tolerance = kUnitTolerance * s.usual_length;
  s.usual_share =
      double(std::ranges::count_if(lengths, [&](double l) { return std::abs(l - s.usual_length) < tolerance; }));
  for (double* share : {&s.mean_length, &s.unorm_mean_length, &s.unit_share, &s.unorm_unit_share, &s.usual_share})
    *share /= double(s.count);
  return s;
}

std::vector<float> planar_depths(std::span<const float> raw, const DepthMap& map, const View& view, int row_step) {
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  std::vector<float> planar;
  planar.reserve(plane / std::size_t(row_step) + std::size_t(view.size.x));
  for (int y = 0; y < view.size.y; y += row_step)
    for (int x = 0; x < view.size.x; x++) planar.push_back(float(planar_depth_at(map, raw, view, x, y)));
  return planar;
}

std::optional<double> reprojection_error(std::span<const float> position, PositionSpace space, bool mirrored,
                                         const Camera& camera, const View& view) {
  const std::size_t plane = position.size() / 3;
  const int stride = sparseness(view);
  std::vector<double> errors;
  for (int y = 0; y < view.size.y; y += stride)
    for (int x = 0; x < view.size.x; x += stride) {
      const std::size_t i = index_of(view, x, y);
      Vector3 p{position[i], position[i + plane], position[i + 2 * plane]};
      if (!(dot(p, p) > 0) || !(dot(p, p) < 1e18)) continue;
      if (space == PositionSpace::world) {
        p = sum(times(*camera.view_from_world, p), camera.view_from_world_offset);
      } else if (camera.left_handed != mirrored) {
        p[2] = -p[2];
      }
      errors.push_back(pixels_beside(view, x, y, p));
    }
  return errors.empty() ? std::nullopt : std::optional(median_of(std::move(errors)));
}

}  // namespace alcove
