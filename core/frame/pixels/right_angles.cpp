// Flat places, the shifts that pairs of them give, and the shift that most of these share.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/right_angles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/ranks.h"
#include "core/frame/camera/linear.h"
#include "core/frame/pixels/places.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

constexpr int kArm = 5;                  // px from the middle of a flat place to its sides
constexpr std::size_t kPlanes = 400;     // that are paired
constexpr double kLeastPairs = 0.05;     // of them that agree
constexpr double kWidth = 0.02;          // of the median value above a shift: shifts within it are one
constexpr double kPerpendicular = 0.05;  // cosine

/// The p, q and r of a place, if it is flat and slanted.
std::optional<Vector3> plane_at(const View& view, std::span<const float> raw, int x, int y, double step) {
  constexpr double kBend = 0.002, kLeastSteps = 20, kLeastSlope = 1e-6;  // of the slope; steps; of the value
  std::array<double, 9> d;
  for (int i = 0; i < 9; i++) d[std::size_t(i)] = raw[index_of(view, x + (i % 3 - 1) * kArm, y + (i / 3 - 1) * kArm)];
  const double across = (d[2] + d[5] + d[8] - d[0] - d[3] - d[6]) / 6,
               down = (d[6] + d[7] + d[8] - d[0] - d[1] - d[2]) / 6;
  double middle = 0, bend = 0;
  for (const double value : d) middle += value / 9;
  for (int i = 0; i < 9; i++)
    bend = std::max(bend, std::abs(d[std::size_t(i)] - middle - (i % 3 - 1) * across - (i / 3 - 1) * down));
  const double slope = std::hypot(across, down);
  if (!(bend <= std::max(kBend * slope, step)) || slope < std::max(kLeastSteps * step, kLeastSlope * std::abs(middle)))
    return std::nullopt;
  const Vector3 ray = tangent_at(view, x, y);
  const double p = across / (kArm * view.tangent_per_pixel.x), q = down / (kArm * view.tangent_per_pixel.y);
  return Vector3{p, q, middle - p * ray[0] - q * ray[1]};
}

std::vector<Vector3> planes_of(const View& view, std::span<const float> raw, double step) {
  std::vector<Vector3> all, some;
  const int sparse = sparseness(view);
  for (int y = kArm; y + kArm < view.size.y; y += sparse)
    for (int x = kArm; x + kArm < view.size.x; x += sparse)
      if (const auto plane = plane_at(view, raw, x, y, step)) all.push_back(*plane);
  for (std::size_t i = 0; i < all.size(); i += all.size() / kPlanes + 1) some.push_back(all[i]);
  return some;
}

double cosine(const Vector3& a, const Vector3& b, double shift) {
  const Vector3 m{a[0], a[1], shift - a[2]}, n{b[0], b[1], shift - b[2]};
  return dot(m, n) / (length(m) * length(n));
}

/// Whether three of the planes are perpendicular to each other.
bool has_corner(const std::vector<Vector3>& planes, double shift) {
  const auto are = [&](const Vector3& a, const Vector3& b) { return std::abs(cosine(a, b, shift)) < kPerpendicular; };
  for (const auto& a : planes) {
    std::vector<Vector3> others;
    std::ranges::copy_if(planes, std::back_inserter(others), [&](const auto& b) { return are(a, b); });
    for (const auto& b : others)
      if (std::ranges::any_of(others, [&](const auto& c) { return are(b, c); })) return true;
  }
  return false;
}

}  // namespace

std::optional<RightAngles> shift_by_right_angles(const View& view, std::span<const float> raw, const Grain& grain) {
  const std::vector<Vector3> planes = planes_of(view, raw, grain.step);
  if (planes.size() < kPlanes / 10) return std::nullopt;
  std::vector<double> levels, shifts;
  for (std::size_t i = 0; i < raw.size(); i += kSparse)
    if (std::isfinite(raw[i])) levels.push_back(raw[i]);
  const double median = median_of(levels), least = std::ranges::min(levels);
  for (std::size_t i = 0; i < planes.size(); i++)
    for (std::size_t j = 0; j < i; j++) {
      const auto &a = planes[i], &b = planes[j];
      const double half = 0.5 * (a[2] + b[2]), root = std::sqrt(half * half - dot(a, b));
      for (const double shift : {half - root, half + root})  // not a number where no shift makes them perpendicular
        if (shift <= least + kWidth * (median - least)) shifts.push_back(shift);
    }
  std::ranges::sort(shifts);
  const auto within = [&](double shift) {
    const double width = kWidth * (median - shift);
    return std::ranges::upper_bound(shifts, shift + width) - std::ranges::lower_bound(shifts, shift - width);
  };
  const auto best = std::ranges::max_element(shifts, {}, within);
  if (best == shifts.end() || double(within(*best)) < kLeastPairs * 0.5 * std::pow(double(planes.size()), 2))
    return std::nullopt;
  const double shift = *best, error = kWidth * (median - shift);
  if (!has_corner(planes, shift)) return std::nullopt;
  return RightAngles{shift, error};
}

}  // namespace alcove
