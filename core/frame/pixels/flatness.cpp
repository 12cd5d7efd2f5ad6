// Least-squares fits over blocks of pixels, and common divisors of values.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/flatness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Blocks. Their sides are parts of the picture's longer side: a small one finds more flat places, and a large one sees
// further below the rounding of the values.
constexpr std::array kSidesPerPicture = {24, 12, 48};  // tried in this order until one tells
constexpr int kLeastSide = 9;                          // px
constexpr std::size_t kAcross = 9;                     // samples of a block in x and in y
constexpr std::size_t kSamples = kAcross * kAcross;
constexpr std::size_t kLeastBlocks = 12;  // fewer smooth ones tell nothing

// The limits of flat. Second-degree terms are amplitudes at the block's edge, relative to the block's mean.
constexpr double kSmooth = 0.005;        // largest residual of one surface
constexpr double kEdge = 0.05;           // a residual that no reading makes smooth
constexpr double kNoise = 0.6;           // of the residual: an amplitude that noise may feign
constexpr double kStep = 0.3;            // of the step: the same for rounded values
constexpr double kFloatRounding = 3e-7;  // the same for exact values
constexpr double kClearly = 2;           // another kind is refuted from so many times that amplitude on
constexpr double kTells = 0.1;           // a share that needs no other size of blocks

/// The polynomials of second degree over a block, orthonormal over its samples: 1, x, y and three of second degree.
constexpr std::size_t kTerms = 6;
struct Basis {
  std::array<int, kAcross> at{};  // px from the block's corner
  std::array<std::array<double, kSamples>, kTerms> terms{};

  explicit Basis(int side) {
    const double half = 0.5 * (side - 1);
    for (std::size_t i = 0; i < kAcross; i++) at[i] = int(std::lround(double(i) * (side - 1) / (kAcross - 1)));
    for (std::size_t i = 0; i < kSamples; i++) {
      const double x = (at[i % kAcross] - half) / half, y = (at[i / kAcross] - half) / half;
      const std::array powers{1.0, x, y, x * x, x * y, y * y};
      for (std::size_t k = 0; k < kTerms; k++) terms[k][i] = powers[k];
    }
    for (std::size_t k = 0; k < kTerms; k++) {  // Gram-Schmidt
      for (std::size_t j = 0; j < k; j++) {
        double along = 0;
        for (std::size_t i = 0; i < kSamples; i++) along += terms[k][i] * terms[j][i];
        for (std::size_t i = 0; i < kSamples; i++) terms[k][i] -= along * terms[j][i];
      }
      double squared = 0;
      for (double t : terms[k]) squared += t * t;
      for (double& t : terms[k]) t /= std::sqrt(squared);
    }
  }
};

using Samples = std::array<double, kSamples>;

/// The result of a fit, relative to the block's mean: amplitudes of the line and of the second-degree terms at the
/// block's edge, and the root mean square of the rest.
struct Fit {
  double slope = 0, bend = 0, residual = 0;
  std::array<double, kTerms> terms{};
};
// From the root mean squares of x and of x^2 over nine samples from -1 to 1 to their amplitudes.
constexpr double kLineEdge = 1.549, kSquareEdge = 2.735;

Fit fit(const Samples& values, const Basis& basis) {
  double mean = 0;
  for (double value : values) mean += value;
  mean /= double(kSamples);
  // Without the mean, the residual is a difference of sums of squares that are exact enough for it.
  Samples rest;
  double squares = 0;
  for (std::size_t i = 0; i < kSamples; i++) {
    rest[i] = values[i] / mean - 1;
    squares += rest[i] * rest[i];
  }
  std::array<double, kTerms> c{};
  for (std::size_t k = 1; k < kTerms; k++) {
    for (std::size_t i = 0; i < kSamples; i++) c[k] += rest[i] * basis.terms[k][i];
    squares -= c[k] * c[k];
  }
  const double scale = 1 / std::sqrt(double(kSamples));
  return {kLineEdge * std::hypot(c[1], c[2]) * scale, kSquareEdge * std::hypot(c[3], c[4], c[5]) * scale,
          std::sqrt(std::max(squares, 0.0) / double(kSamples - kTerms)), c};
}

/// The largest number of which all differences between neighbours are multiples, by Euclid's algorithm within the
/// rounding of floats near `value`; 0 where that rounding hides it.
double common_step(std::span<const double> sorted, double value) {
  constexpr double kEnough = 20;  // bits: chance makes one sequence of differences in a million look so
  const double rounding = value * 0x1p-22;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted.size(); i++) gaps.push_back(sorted[i] - sorted[i - 1]);
  std::ranges::sort(gaps);
  double divisor = gaps.front(), bits = 0;
  for (double gap : gaps)
    while (divisor > 16 * rounding) {
      const double times = std::round(gap / divisor), rest = std::abs(gap - times * divisor);
      // The divisor's own error counts so many times. Where that is much of it, anything may be a multiple.
      const double error = 2 * (times + 1) * rounding, by_chance = 2 * error / divisor;
      if (by_chance > 0.5) break;
      if (rest <= error) {
        divisor = gap / times;  // the larger the gap, the better it tells
        bits -= std::log2(by_chance);
        break;
      }
      gap = std::exchange(divisor, rest);
      bits = 0;
    }
  return divisor > 16 * rounding && bits > kEnough ? divisor : 0;
}

/// The count of each of the sorted values.
std::vector<std::size_t> counts_of_equal(std::span<const double> sorted) {
  std::vector<std::size_t> counts;
  for (std::size_t i = 0; i < sorted.size(); i++) {
    if (i == 0 || sorted[i] != sorted[i - 1]) counts.push_back(0);
    counts.back()++;
  }
  return counts;
}

/// The step of values of about this size, relative to them.
double relative_step(const Grain& grain, double value) {
  if (grain.step == 0) return 0;
  return grain.is_fixed ? grain.step / value : std::max(grain.is_half ? 0x1p-10 : 0, grain.step / grain.median);
}

/// Calls `visit` with the samples of every block that holds nothing but surfaces, and with the lengths of their rays.
/// `value_of` gives the value of a pixel by its number and its ray, infinite where there is no surface.
template <class ValueOf, class Visit>
void for_each_block(const View& view, int side, int step, const Basis& basis, const ValueOf& value_of,
                    const Visit& visit) {
  Samples values, lengths;
  const auto take = [&](int left, int top) {
    for (std::size_t i = 0; i < kSamples; i++) {
      const int x = left + basis.at[i % kAcross], y = top + basis.at[i / kAcross];
      lengths[i] = ray_length(view, x, y);
      values[i] = value_of(std::size_t(y) * std::size_t(view.size.x) + std::size_t(x), lengths[i]);
      if (!std::isfinite(values[i])) return false;
    }
    return true;
  };
  for (int y = 0; y + side <= view.size.y; y += step)
    for (int x = 0; x + side <= view.size.x; x += step)
      if (take(x, y)) visit(values, lengths);
}

int side_of(const View& view, int per_picture) {
  const int side = std::max(view.size.x, view.size.y) / per_picture | 1;
  return std::min(std::max(side, kLeastSide), std::min(view.size.x, view.size.y));
}

Samples quotients(const Samples& over, const Samples& under) {
  Samples q;
  for (std::size_t i = 0; i < kSamples; i++) q[i] = over[i] / under[i];
  return q;
}

/// What a block that shows a plane says of the curve of its values.
struct CurvePoint {
  double value, ratio;  // v and v'^2 / v''
};

/// The kinds by which a block is flat, of planar, ray and inverse; whether it is smooth at all.
struct Flat {
  bool is_smooth = false;
  std::array<bool, 3> by{};
  std::optional<CurvePoint> curve;
};

/// Over a plane the second derivatives of any function of 1/z vanish across its gradient. A block that is curved
/// across it shows no plane, and one that is hardly curved along it says nothing.
std::optional<CurvePoint> curve_point(const Fit& fit, double mean, double noise) {
  constexpr double kLeastSlope = 0.02, kMostSlope = 0.15;  // relative change from the block's middle to its edge
  constexpr double kAcross = 0.03;                         // of the curvature that distances of the same slope have
  constexpr double kClear = 10;                            // times the noise
  // The norms of x, x y and x^2 without its mean over the samples.
  constexpr double kLine = 5.80948, kCross = 3.75, kSquare = 3.29060;
  const double x = fit.terms[1] / kLine, y = fit.terms[2] / kLine, slope = std::hypot(x, y);
  if (slope < kLeastSlope || slope > kMostSlope) return std::nullopt;
  const double xx = 2 * fit.terms[3] / kSquare, xy = fit.terms[4] / kCross, yy = 2 * fit.terms[5] / kSquare;
  const double nx = x / slope, ny = y / slope, usual = slope * slope;
  const double along = xx * nx * nx + 2 * xy * nx * ny + yy * ny * ny;
  const double across = xx * ny * ny - 2 * xy * nx * ny + yy * nx * nx;
  const double between = (yy - xx) * nx * ny + xy * (nx * nx - ny * ny);
  if (std::hypot(across, between) > kAcross * usual + noise || usual < kClear * noise) return std::nullopt;
  if (fit.residual > kAcross * usual + 0.3 * usual * slope) return std::nullopt;
  return CurvePoint{mean, along == 0 ? kInfinity : mean * usual / along};
}

/// A line through the thirds of the points with the least and the largest values.
Curve curve_of(std::vector<CurvePoint> points) {
  constexpr double kLeastRange = 1.05;  // from the smaller to the larger values
  constexpr double kClear = 5;          // times the spread
  constexpr double kStraight = 50;      // times the value: the values themselves are affine over planes
  constexpr double kMostStraight = 0.2;
  const auto count = points.size();
  std::erase_if(points, [](const CurvePoint& p) { return !(std::abs(p.ratio) < kStraight * p.value); });
  if (points.size() < kLeastBlocks || double(points.size()) < (1 - kMostStraight) * double(count)) return {};
  std::ranges::sort(points, {}, &CurvePoint::value);
  const auto middle_of = [](std::span<const CurvePoint> some, double CurvePoint::*member) {
    std::vector<double> values;
    for (const auto& point : some) values.push_back(point.*member);
    return median_of(std::move(values));
  };
  const std::span all(points), low = all.first(all.size() / 3), high = all.last(all.size() / 3);
  const double least = middle_of(low, &CurvePoint::value), most = middle_of(high, &CurvePoint::value);
  Curve curve{.planes = points.size(), .median = middle_of(all, &CurvePoint::value)};
  if (most > kLeastRange * least)
    curve.slope = (middle_of(high, &CurvePoint::ratio) - middle_of(low, &CurvePoint::ratio)) / (most - least);
  std::vector<double> rests;
  for (const auto& point : points) rests.push_back(point.ratio - curve.slope * point.value);
  curve.offset = median_of(rests);
  for (double& rest : rests) rest = std::abs(rest - curve.offset) / curve.median;
  curve.spread = median_of(std::move(rests));
  curve.is_wide = most > kLeastRange * least && most - least > kClear * curve.spread * curve.median;
  return curve;
}

Flat flat_by(const Samples& values, const Samples& lengths, bool is_orthographic, const Basis& basis,
             const Grain& grain) {
  Samples ones;
  ones.fill(1);
  const Fit value = fit(values, basis);
  if (value.residual > kEdge) return {};
  const Fit inverse = fit(quotients(ones, values), basis);
  std::array fits{inverse, is_orthographic ? inverse : fit(quotients(lengths, values), basis), value};
  if (is_orthographic) std::swap(fits[0], fits[2]);
  const double residual = std::ranges::min(fits, {}, &Fit::residual).residual;
  Flat flat;
  flat.is_smooth = residual < kSmooth;
  if (!flat.is_smooth) return flat;
  const double step = relative_step(grain, values[kSamples / 2]);
  const double noise = kNoise * residual + kStep * step + kFloatRounding;
  double mean = 0;
  for (const double v : values) mean += v / double(kSamples);
  if (!is_orthographic) flat.curve = curve_point(value, mean, kStep * step + kFloatRounding);
  for (std::size_t k = 0; k < 3; k++) {
    if (is_orthographic && k == 1) continue;
    bool is_alone = fits[k].bend < noise;
    for (std::size_t other = 0; other < 3; other++)
      is_alone &= other == k || (is_orthographic && other == 1) || fits[other].bend > kClearly * noise;
    flat.by[k] = is_alone;
  }
  return flat;
}

/// The scores by blocks of one size, none where too few of them are smooth; and the curve of the values.
struct BlockScores {
  std::vector<DepthScore> scores;
  std::vector<CurvePoint> curve;
};
BlockScores scores_by(std::span<const float> raw, const View& view, double sky, int side, const Grain& grain) {
  std::vector<DepthScore> scores{{DepthKind::planar}, {DepthKind::ray}, {DepthKind::inverse}};
  std::vector<CurvePoint> curve;
  if (side < kLeastSide) return {};
  const Basis basis(side);
  std::size_t count = 0;
  // Large blocks overlap by more, so that there are enough of them; those of a small picture by no more than that.
  const int step = std::max(side / 4, std::min(side / 2, std::max(view.size.x, view.size.y) / 48));
  const auto value_of = [&](std::size_t i, double) {
    const double value = std::abs(double(raw[i]));
    return value > 0 && value < sky ? value : kInfinity;
  };
  for_each_block(view, side, step, basis, value_of, [&](const Samples& values, const Samples& lengths) {
    const Flat flat = flat_by(values, lengths, view.orthographic != 0, basis, grain);
    count += flat.is_smooth;
    if (flat.curve) curve.push_back(*flat.curve);
    for (std::size_t k = 0; k < 3; k++) scores[k].straight += flat.by[k];
  });
  if (count < kLeastBlocks) return {};
  for (auto& score : scores) score.straight /= double(count);
  std::ranges::stable_sort(scores, std::greater(), &DepthScore::straight);
  return {std::move(scores), std::move(curve)};
}

constexpr std::size_t kAbout = 32;  // neighbours whose differences are looked at
constexpr std::size_t kFewest = 8;  // values; fewer may be as many walls that face the camera

/// A value, and the step from it to the next.
struct Place {
  double value, step;
};

/// The values of a sample, in their order.
std::vector<double> sorted_values(std::span<const float> raw, double sky) {
  constexpr std::size_t kSampled = 1 << 14;
  std::vector<float> values;
  for (std::size_t i = 0, step = raw.size() / kSampled + 1; i < raw.size(); i += step)
    if (const float v = std::abs(raw[i]); v > 0 && v < sky && std::isfinite(v)) values.push_back(v);
  std::ranges::sort(values);
  return {values.begin(), values.end()};
}

/// The step at a part of the way through different values; 0: there is none. `counts` says how frequent each is.
Place place_at(double part, std::span<const double> values, std::span<const std::size_t> counts) {
  const std::size_t about = std::min(kAbout, values.size());
  const std::size_t first = std::size_t(part * double(values.size() - about));
  const double value = values[first + about / 2], step = common_step(values.subspan(first, about), value);
  // A plane whose depth changes by as much from row to row has one step too, and each of its values is as frequent.
  const auto [least, most] = std::ranges::minmax(counts.subspan(first, about));
  const bool is_ramp =
      most - least <= 1 && values[first + about - 1] - values[first] < 1.001 * double(about - 1) * step;
  return {value, is_ramp ? 0 : step};
}

/// Whether all of a few values, which may be those of walls, are multiples of a step.
bool are_multiples(std::span<const double> values, double step) {
  constexpr double kExact = 0.01;
  return std::ranges::all_of(values, [&](double v) { return std::abs(v / step - std::round(v / step)) < kExact; });
}

/// Whether these are all whole numbers of a range: hardly any walls stand so.
bool are_whole_numbers(std::span<const double> values) {
  constexpr std::size_t kLeast = 4;
  return values.size() >= kLeast && values.back() - values.front() == double(values.size() - 1) &&
         std::ranges::all_of(values, [](double v) { return v == std::round(v); });
}

}  // namespace

Grain grain_of(std::span<const float> raw, double sky, bool orthographic) {
  constexpr double kCoarse = 0x1p-14;  // of the value: finer steps do no harm
  std::vector<double> values = sorted_values(raw, sky);
  if (values.empty()) return {};
  Grain grain{values[values.size() / 2]};
  const std::vector<std::size_t> counts = counts_of_equal(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  const bool are_few = values.size() < 2 * kAbout;
  if (values.size() < kFewest && !are_whole_numbers(values)) return grain;
  // Stairs from above have few distances, and so have walls in fractions of a range.
  if (are_few && (orthographic || values.back() <= 1)) return grain;
  const std::array places{place_at(0.1, values, counts), place_at(0.5, values, counts), place_at(0.9, values, counts)};
  grain.step = places[1].step;
  if (are_few && grain.step > 0 && !are_multiples(values, grain.step)) grain.step = 0;
  if (grain.step == 0) return grain;
  grain.median = places[1].value;
  grain.is_coarse = grain.step >= kCoarse * grain.median;
  const auto is_same = [&](const Place& p) { return std::abs(p.step / grain.step - 1) < 0.01; };
  // At the border of two powers of two the smaller step stands beside the larger value.
  const auto is_of_half = [](const Place& p) {
    return p.step >= 0.99 * 0x1p-12 * p.value && p.step <= 1.01 * 0x1p-10 * p.value;
  };
  const bool are_same = std::ranges::all_of(places, is_same), is_wide = places[2].value > 2.1 * places[0].value;
  const bool is_power = std::abs(std::log2(grain.step) - std::round(std::log2(grain.step))) < 0.01;
  grain.is_half = std::ranges::all_of(places, is_of_half) && !(are_same && (is_wide || !is_power));
  grain.is_fixed = are_same && !grain.is_half;
  return grain;
}

DepthShape shape_of(std::span<const float> raw, const View& view, double sky, const Grain& grain) {
  std::vector<DepthScore> best;
  std::vector<CurvePoint> points;
  std::set<int> tried;
  for (const int per_picture : kSidesPerPicture) {
    // In a small picture several parts are of the least size, and the same block counts once.
    if (!tried.insert(side_of(view, per_picture)).second) continue;
    auto [scores, curve] = scores_by(raw, view, sky, side_of(view, per_picture), grain);
    std::ranges::move(curve, std::back_inserter(points));
    if (!scores.empty() && (best.empty() || scores[0].straight > best[0].straight)) best = std::move(scores);
    if (!best.empty() && best[0].straight >= kTells) break;
  }
  return {std::move(best), curve_of(std::move(points))};
}

std::optional<double> jitter_of(std::span<const float> raw, const DepthMap& map, const View& view, const Grain& grain) {
  constexpr double kSmoothNoise = 0.03;    // largest residual, which noise of steep surfaces reaches
  constexpr double kLeastSlope = 1e-4;     // of 1/z from pixel to pixel, relative
  constexpr double kLeast = 0.05;          // less hardly shows
  constexpr double kMost = 0.4;            // more is relief
  constexpr double kSame = 1.3;            // surfaces of all slopes have the same noise, within this factor
  constexpr std::size_t kLeastCount = 40;  // blocks
  const int side = side_of(view, 48), step = std::max(side, std::max(view.size.x, view.size.y) / 24);
  if (side < kLeastSide) return std::nullopt;
  const Basis basis(side);
  const double per_pixel = 1 / (0.5 * (side - 1));
  std::vector<double> noises;
  Samples ones;
  ones.fill(1);
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  const auto depth_of = [&](std::size_t i, double length) {
    return planar_depth(map, value_at(raw, plane, i), length);
  };
  for_each_block(view, side, step, basis, depth_of, [&](const Samples& values, const Samples&) {
    const Fit f = fit(quotients(ones, values), basis);
    const double slope = f.slope * per_pixel, rounding = relative_step(grain, values[kSamples / 2]);
    if (f.residual < kSmoothNoise && slope > kLeastSlope && slope > 4 * rounding)
      noises.push_back(f.residual < rounding ? 0 : f.residual / slope);
  });
  if (noises.size() < kLeastCount) return std::nullopt;
  std::ranges::sort(noises);
  const double few = noises[noises.size() / 20], some = noises[3 * noises.size() / 20];
  return few >= kLeast && few <= kMost && some < kSame * few ? std::optional(some) : std::nullopt;
}

}  // namespace alcove
