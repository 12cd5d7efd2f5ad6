// Stretches of flat surfaces, and the shift that each of them gives; flat places, and the shift that most pairs share.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/disparity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/ranks.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

constexpr std::size_t kLeastStretches = 200;  // fewer tell nothing
constexpr std::size_t kBlocks = 4;            // of the picture, across and down, each left out once

/// Two pixels of a flat surface. Their disparities, their rays at unit depth, and the unit normal between them.
struct Stretch {
  std::array<double, 2> disparity;
  std::array<Vector3, 2> ray;
  Vector3 normal;     // as in the file
  std::size_t block;  // of the picture

  double middle() const { return 0.5 * (disparity[0] + disparity[1]); }
  double slope() const { return disparity[1] - disparity[0]; }
};

/// Finds stretches along rows and columns.
class StretchFinder {
 public:
  StretchFinder(const NormalPlanes& planes, const Grain& grain)
      : planes_(planes), grain_(grain), pixels_(std::size_t(planes.view.size.x) * std::size_t(planes.view.size.y)) {}

  std::vector<Stretch> all() const {
    const auto& size = planes_.view.size;
    const int step = sparseness(planes_.view);
    std::vector<Stretch> found;
    for (int y = 0; y < size.y; y += step)
      for (int x = 0; x < size.x; x += step)
        for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}})
          if (const auto stretch = longest(x, y, dx, dy)) found.push_back(*stretch);
    return found;
  }

 private:
  double disparity(int x, int y) const { return planes_.raw[index_of(planes_.view, x, y)]; }
  Vector3 normal(int x, int y) const {
    const Vector3 n =
        decoded_normal(planes_.normal, pixels_, index_of(planes_.view, x, y), planes_.encoding, planes_.unorm);
    return scaled(n, 1 / length(n));
  }
  double step_at(double disparity) const {
    return grain_.is_fixed || grain_.median == 0 ? grain_.step : grain_.step / grain_.median * std::abs(disparity);
  }

  /// The longest stretch about a pixel in which nothing bends: longer ones are less harmed by rounding.
  std::optional<Stretch> longest(int x, int y, int dx, int dy) const {
    constexpr int kMost = 32;  // px to each side
    const Vector3 here = normal(x, y);
    std::optional<Stretch> found;
    for (int reach = 1; reach <= kMost; reach *= 2) {
      const auto stretch = flat(x, y, reach * dx, reach * dy, here);
      if (!stretch) break;
      found = stretch;
    }
    return found;
  }

  std::optional<Stretch> flat(int x, int y, int dx, int dy, const Vector3& here) const {
    constexpr double kParallel = 0.9995;  // cosine of the normals
    constexpr double kBend = 0.02;        // of the slope
    const auto& [width, height] = planes_.view.size;
    if (x < dx || y < dy || x + dx >= width || y + dy >= height) return std::nullopt;
    if (!(dot(normal(x - dx, y - dy), here) > kParallel) || !(dot(normal(x + dx, y + dy), here) > kParallel))
      return std::nullopt;
    const double before = disparity(x - dx, y - dy), after = disparity(x + dx, y + dy), middle = disparity(x, y);
    if (!(std::abs(before + after - 2 * middle) <= std::max(kBend * std::abs(after - before), 1.01 * step_at(middle))))
      return std::nullopt;
    return Stretch{
        {before, after},
        {tangent_at(planes_.view, x - dx, y - dy), tangent_at(planes_.view, x + dx, y + dy)},
        here,
        std::size_t(y) * kBlocks / std::size_t(height) * kBlocks + std::size_t(x) * kBlocks / std::size_t(width)};
  }

  const NormalPlanes& planes_;
  const Grain& grain_;
  const std::size_t pixels_;
};

/// What a stretch says by one reading of its normal: 1/z changes by the part `turn` along it, so the shift is `shift`.
struct Say {
  double shift, turn, weight;
  const Stretch* stretch;
};

std::vector<Say> says_of(const std::vector<Stretch>& stretches, const Matrix3& view_from_normal) {
  std::vector<Say> says;
  for (const auto& stretch : stretches) {
    const Vector3 normal = times(view_from_normal, stretch.normal);
    const double first = dot(normal, stretch.ray[0]), second = dot(normal, stretch.ray[1]);
    const double turn = 2 * (second - first) / (second + first);
    if (!(turn != 0) || !(first * second > 0)) continue;
    const double shift = stretch.middle() - stretch.slope() / turn;
    says.push_back({shift, turn, std::abs(turn), &stretch});
  }
  std::ranges::sort(says, {}, &Say::shift);
  return says;
}

/// The weighted median, without one block of the picture. `says` are sorted.
double shift_of(const std::vector<Say>& says, std::optional<std::size_t> without = std::nullopt) {
  const auto weight = [&](const Say& say) { return say.stretch->block == without ? 0 : say.weight; };
  double left = 0;
  for (const auto& say : says) left += 0.5 * weight(say);
  for (const auto& say : says)
    if ((left -= weight(say)) <= 0) return say.shift;
  return says.back().shift;
}

/// Twice the standard error of the shift, by leaving out each block of the picture.
double error_of(const std::vector<Say>& says, double shift) {
  double squares = 0;
  for (std::size_t block = 0; block < kBlocks * kBlocks; block++) squares += std::pow(shift_of(says, block) - shift, 2);
  return 2 * std::sqrt(squares);
}

/// The part of the slopes that the shift explains.
double agreement_of(const std::vector<Say>& says, double shift) {
  double all = 0, wrong = 0;
  for (const auto& say : says) {
    const double expected = say.turn * (say.stretch->middle() - shift), slope = say.stretch->slope();
    wrong += std::abs(slope - expected);
    all += std::max(std::abs(slope), std::abs(expected));
  }
  return all > 0 ? 1 - wrong / all : 0;
}

/// What normals that are not those of the surfaces may move the shift by. Measured on six rendered scenes, with shading
/// normals and rounded values: at most a quarter of the part that is not explained.
double bias_of(const std::vector<Say>& says, double shift, double agreement) {
  double sum = 0;
  for (const auto& say : says) sum += std::abs(say.stretch->middle() - shift);
  return 0.25 * (1 - agreement) * sum / double(says.size());
}

}  // namespace

std::vector<ShiftScore> score_shifts(const NormalPlanes& planes, const Grain& grain) {
  const std::vector<Stretch> stretches = StretchFinder(planes, grain).all();
  std::vector<ShiftScore> scores;
  for (const NormalSpace space : {NormalSpace::world, NormalSpace::view})
    for (const NormalFlips flips :
         {NormalFlips{}, NormalFlips{.y = true}, NormalFlips{.x = true}, NormalFlips{.z = true}}) {
      if (space == NormalSpace::world && !planes.camera.view_from_world) continue;
      const auto says = says_of(stretches, view_from_normal(planes.camera, space, flips));
      if (says.size() < kLeastStretches) continue;
      const double shift = shift_of(says);
      const double agreement = agreement_of(says, shift);
      const double error = std::max(error_of(says, shift), grain.step) + bias_of(says, shift, agreement);
      scores.push_back({space, flips, shift, error, agreement});
    }
  std::ranges::stable_sort(scores, std::greater(), &ShiftScore::agreement);
  return scores;
}

// Right angles.

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
