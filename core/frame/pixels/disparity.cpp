// Stretches of flat surfaces, and the shift that each of them gives.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/disparity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/frame/pixels/places.h"
#include "core/frame/pixels/statistics.h"

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

}  // namespace alcove
