// Error sums, percentiles, structural similarity, depth edges, grain, mottle.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace alcove {
namespace {

bool counts(Mask mask, std::size_t i) { return mask.empty() || mask[i % mask.size()]; }

/// The error of a value, and its share in the mean square, which is free of the references' noise if there are two.
struct ValueError {
  double reference, error, square;

  ValueError(double t, double a) : reference(a), error(t - a), square(error * error) {}
  ValueError(double t, double a, double b)
      : reference(0.5 * (a + b)), error(t - reference), square((t - a) * (t - b)) {}
  bool finite() const { return std::isfinite(error) && std::isfinite(square); }
};

/// The errors of a plane, value by value.
struct Errors {
  Values result, reference, reference_b;

  ValueError operator[](std::size_t i) const {
    return reference_b.empty() ? ValueError(result[i], reference[i])
                               : ValueError(result[i], reference[i], reference_b[i]);
  }
};

struct Sums {
  std::size_t count = 0;
  double error = 0, size = 0, square = 0;

  void add(const ValueError& e) {
    count++;
    error += e.error;
    size += std::abs(e.error);
    square += e.square;
  }
  double mean(double sum) const { return count ? sum / double(count) : 0; }
  double rmse() const { return std::sqrt(std::max(0.0, mean(square))); }
  PartErrors part() const { return {count, rmse(), mean(error)}; }
};

/// A percentile as numpy.percentile's default: linear between the two nearest ranks. Reorders the values.
double percentile(std::vector<double>& values, double part) {
  const double rank = part * double(values.size() - 1);
  const auto low = values.begin() + std::ptrdiff_t(rank);
  std::nth_element(values.begin(), low, values.end());
  if (low + 1 == values.end()) return *low;
  const double next = *std::min_element(low + 1, values.end());
  return *low + (rank - std::floor(rank)) * (next - *low);
}

/// Adds one plane's SSIM map over the pixels that count, as a sum and a count.
void add_ssim(int width, int height, Values result, Values reference, Mask mask, double peak, double& sum,
              std::size_t& count) {
  constexpr int kRadius = 5;
  static const std::vector<double> window = gaussian_kernel(1.5, kRadius);
  const auto mean_of = [&](auto&& value) {
    std::vector<double> plane(result.size());
    for (std::size_t i = 0; i < plane.size(); i++) plane[i] = value(double(result[i]), double(reference[i]));
    return convolve(width, height, plane, window, window);
  };
  const auto x = mean_of([](double a, double) { return a; }), y = mean_of([](double, double b) { return b; });
  const auto xx = mean_of([](double a, double) { return a * a; }), yy = mean_of([](double, double b) { return b * b; });
  const auto xy = mean_of([](double a, double b) { return a * b; });
  const double c1 = std::pow(0.01 * peak, 2), c2 = std::pow(0.03 * peak, 2);
  for (int row = kRadius; row < height - kRadius; row++)
    for (int column = kRadius; column < width - kRadius; column++) {
      const std::size_t i = std::size_t(row) * std::size_t(width) + std::size_t(column);
      if (!counts(mask, i)) continue;
      const double variance_x = xx[i] - x[i] * x[i], variance_y = yy[i] - y[i] * y[i], covariance = xy[i] - x[i] * y[i];
      sum += (2 * x[i] * y[i] + c1) * (2 * covariance + c2) /
             ((x[i] * x[i] + y[i] * y[i] + c1) * (variance_x + variance_y + c2));
      count++;
    }
}

bool is_surface(float depth, double sky) { return std::isfinite(depth) && depth > 0 && depth < sky; }

bool is_step(float a, float b, double sky) {
  if (is_surface(a, sky) != is_surface(b, sky)) return true;
  return is_surface(a, sky) && std::abs(double(a) - b) > kDepthStep * std::min(a, b);
}

/// Computes to += weight * from.
void add_scaled(double weight, std::span<const double> from, std::span<double> to) {
  for (std::size_t i = 0; i < to.size(); i++) to[i] += weight * from[i];
}

constexpr std::size_t kPlainSide_px = 2 * kPlainReach_px + 1;

/// Whether 1/z at a pixel and at its two neighbours on a line is that of a straight surface. Sky is NaN, so a line with
/// sky is never straight.
bool is_straight(double before, double center, double after, double bend) {
  return std::abs(before + after - 2 * center) < bend * center;
}

/// Marks surfaces that count and do not bend with 1.
std::vector<double> straight_pixels(int width, int height, Values depth, double sky, double bend, Mask mask = {}) {
  std::vector<double> inverse(depth.size());
  std::vector<double> straight(depth.size());
  std::ranges::transform(depth, inverse.begin(), [&](float z) {
    return is_surface(z, sky) ? 1.0 / z : std::numeric_limits<double>::quiet_NaN();
  });
  const auto row = std::size_t(width);
  for (int y = 1; y < height - 1; y++)
    for (int x = 1; x < width - 1; x++) {
      const std::size_t i = std::size_t(y) * row + std::size_t(x);
      const bool along_x = is_straight(inverse[i - 1], inverse[i], inverse[i + 1], bend);
      const bool along_y = is_straight(inverse[i - row], inverse[i], inverse[i + row], bend);
      straight[i] = along_x && along_y && counts(mask, i) ? 1 : 0;
    }
  return straight;
}

/// The sum over the square about each pixel. Beyond the picture, the border's pixels are repeated.
std::vector<double> sum_of_square(int width, int height, const std::vector<double>& values, int reach_px) {
  const std::vector<double> ones(std::size_t(2 * reach_px + 1), 1);
  return convolve(width, height, values, ones, ones);
}

/// Marks the pixels with 1 whose whole square is marked so.
std::vector<std::uint8_t> with_whole_square(int width, int height, const std::vector<double>& marks, int reach_px) {
  const auto marked = sum_of_square(width, height, marks, reach_px);
  std::vector<std::uint8_t> whole(marks.size());
  std::ranges::transform(marked, whole.begin(), [&](double count) { return count == std::pow(2 * reach_px + 1, 2); });
  return whole;
}

/// The error minus its mean over the square about each pixel.
std::vector<double> residual(int width, int height, Values result, Values reference) {
  static const std::vector<double> mean(kPlainSide_px, 1.0 / kPlainSide_px);
  std::vector<double> error(result.size());
  std::ranges::transform(result, reference, error.begin(), [](double t, double a) { return t - a; });
  add_scaled(-1, convolve(width, height, error, mean, mean), error);
  return error;
}

}  // namespace

PlaneErrors compare_planes(Values result, Values reference, Mask mask, Values reference_b) {
  const Errors errors{result, reference, reference_b};
  PlaneErrors total;
  Sums sums;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < result.size(); i++) {
    if (!counts(mask, i)) continue;
    const ValueError error = errors[i];
    if (!error.finite()) {
      total.excluded++;
      continue;
    }
    sums.add(error);
    sizes.push_back(std::abs(error.error));
  }
  if (sizes.empty())
    fail(ErrorKind::input, "there is no value to compare: {} are NaN or infinite, and the mask leaves out the rest",
         total.excluded);
  total.count = sums.count;
  total.rmse = sums.rmse();
  total.mae = sums.mean(sums.size);
  total.bias = sums.mean(sums.error);
  total.max = *std::ranges::max_element(sizes);
  total.p95 = percentile(sizes, 0.95);
  total.p99 = percentile(sizes, 0.99);
  return total;
}

double psnr(double rmse, double peak) { return 20 * std::log10(peak / rmse); }

std::vector<float> Comparable::mean_reference() const {
  if (reference_b.empty()) return reference;
  std::vector<float> mean(reference.size());
  std::ranges::transform(reference, reference_b, mean.begin(), [](double a, double b) { return float(0.5 * (a + b)); });
  return mean;
}

Comparable make_comparable(const std::string& what, std::size_t pixels, Values result, Values reference,
                           Values reference_b, Mask mask) {
  const auto copy = [](Values values) { return std::vector<float>(values.begin(), values.end()); };
  Comparable c{copy(result), copy(reference), copy(reference_b), std::vector<std::uint8_t>(pixels, 1)};
  std::vector<std::uint8_t> holes(pixels);
  for (std::size_t i = 0; i < result.size(); i++) {
    const int files = reference_b.empty() ? 2 : 3;
    const bool is_finite = std::isfinite(result[i]);
    const int finite =
        int(is_finite) + int(std::isfinite(reference[i])) + int(!reference_b.empty() && std::isfinite(reference_b[i]));
    if (finite < files) c.mask[i % pixels] = 0;
    if (finite == 0 || finite == files || !counts(mask, i)) continue;
    holes[i % pixels] = 1;
    if (!c.first_hole) c.first_hole = Hole{i, !is_finite};
  }
  c.holes = std::size_t(std::ranges::count(holes, 1));
  for (std::size_t pixel = 0; pixel < pixels; pixel++) {
    (!counts(mask, pixel) ? c.masked : c.mask[pixel] ? c.count : c.excluded)++;
    if (!counts(mask, pixel)) c.mask[pixel] = 0;
  }
  if (c.count == 0)
    fail(ErrorKind::input,
         "{}: there is no pixel to compare: of {}, {} are left out by the mask and {} are NaN or infinite", what,
         pixels, c.masked, c.excluded);
  for (std::size_t i = 0; i < result.size(); i++) {
    if (c.mask[i % pixels]) continue;
    c.reference[i] = c.result[i] = std::isfinite(reference[i]) ? reference[i] : 0;
    if (!reference_b.empty()) c.reference_b[i] = c.reference[i];
  }
  return c;
}

std::optional<double> ssim(int width, int height, Values result, Values reference, Mask mask, double peak) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t plane = 0; plane < result.size(); plane += pixels)
    add_ssim(width, height, result.subspan(plane, pixels), reference.subspan(plane, pixels), mask, peak, sum, count);
  return count ? std::optional(sum / double(count)) : std::nullopt;
}

std::array<BandErrors, 4> darkness_bands(Values result, Values reference, Mask mask, Values reference_b) {
  const Errors errors{result, reference, reference_b};
  std::array<Sums, 4> sums;
  for (std::size_t i = 0; i < result.size(); i++) {
    const ValueError error = errors[i];
    if (counts(mask, i) && error.finite()) sums[std::size_t(std::clamp(4 * error.reference, 0.0, 3.0))].add(error);
  }
  std::array<BandErrors, 4> bands;
  for (std::size_t i = 0; i < bands.size(); i++) bands[i] = {0.25 * double(i), 0.25 * double(i + 1), sums[i].part()};
  return bands;
}

std::vector<std::uint8_t> surfaces(Values depth, double sky) {
  std::vector<std::uint8_t> mask(depth.size());
  std::ranges::transform(depth, mask.begin(), [&](float z) { return is_surface(z, sky); });
  return mask;
}

std::vector<std::uint8_t> depth_edges(int width, int height, Values depth, double sky) {
  std::vector<std::uint8_t> edges(depth.size());
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
  const auto mark = [&](int left, int top, int right, int bottom) {  // marks the reach of a step between two pixels
    for (int y = std::max(top - kEdgeReach_px, 0); y <= std::min(bottom + kEdgeReach_px, height - 1); y++)
      for (int x = std::max(left - kEdgeReach_px, 0); x <= std::min(right + kEdgeReach_px, width - 1); x++)
        edges[at(x, y)] = 1;
  };
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      if (x + 1 < width && is_step(depth[at(x, y)], depth[at(x + 1, y)], sky)) mark(x, y, x + 1, y);
      if (y + 1 < height && is_step(depth[at(x, y)], depth[at(x, y + 1)], sky)) mark(x, y, x, y + 1);
    }
  return edges;
}

EdgeErrors edge_errors(Mask edges, Values result, Values reference, Mask mask, Values reference_b) {
  const Errors errors{result, reference, reference_b};
  Sums at, away;
  for (std::size_t i = 0; i < result.size(); i++) {
    const ValueError error = errors[i];
    if (counts(mask, i) && error.finite()) (counts(edges, i) ? at : away).add(error);
  }
  return {at.part(), away.part()};
}

std::vector<std::uint8_t> plain_pixels(int width, int height, Values depth, double sky, Mask mask) {
  // No pixel of the border is straight, and beyond the picture these are repeated.
  const auto straight = straight_pixels(width, height, depth, sky, kPlainBend, mask);
  return with_whole_square(width, height, straight, kPlainReach_px);
}

std::optional<double> grain(int width, int height, Mask plain, Values result, Values reference, Values reference_b) {
  const std::size_t pixels = plain.size();
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t plane = 0; plane < result.size(); plane += pixels) {
    const auto against = [&](Values truth) {
      return residual(width, height, result.subspan(plane, pixels), truth.subspan(plane, pixels));
    };
    const auto a = against(reference);
    const auto b = reference_b.empty() ? a : against(reference_b);
    for (std::size_t i = 0; i < pixels; i++) {
      if (!plain[i]) continue;
      sum += a[i] * b[i];
      count++;
    }
  }
  return count ? std::optional(std::sqrt(std::max(0.0, sum / double(count)))) : std::nullopt;
}

std::vector<std::uint8_t> half_shadow(int width, int height, Values depth, double sky, Values normal, Values truth) {
  const std::size_t pixels = depth.size();
  auto straight = straight_pixels(width, height, depth, sky, kSmoothBend);
  const auto turns = [&](std::size_t i, std::size_t before) {
    double cosine = 0;
    for (std::size_t c = 0; c < normal.size(); c += pixels) cosine += double(normal[c + i]) * normal[c + before];
    return !(cosine > kSmoothCosine);
  };
  for (std::size_t i = 0; i < pixels && !normal.empty(); i++)
    if (straight[i] && (turns(i, i - 1) || turns(i, i - std::size_t(width)))) straight[i] = 0;
  auto half = with_whole_square(width, height, straight, kSmoothReach_px);
  std::vector<double> light(pixels);
  for (std::size_t i = 0; i < pixels; i++) light[i] = half[i] ? truth[i] : 0;
  const auto lights = sum_of_square(width, height, light, kShadowReach_px);
  const auto smooth = sum_of_square(width, height, {half.begin(), half.end()}, kShadowReach_px);
  for (std::size_t i = 0; i < pixels; i++)
    half[i] = half[i] && lights[i] > kShadowFrom * smooth[i] && lights[i] < kShadowTo * smooth[i];
  return half;
}

std::optional<double> mottle(Mask half, std::span<const std::vector<float>> results) {
  const auto n = double(results.size());
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < half.size(); i++) {
    if (!half[i]) continue;
    double mean = 0, variance = 0;
    for (const auto& result : results) mean += result[i] / n;
    for (const auto& result : results) variance += std::pow(result[i] - mean, 2) / (n - 1);
    if (!std::isfinite(variance)) continue;
    sum += variance;
    count++;
  }
  return count ? std::optional(std::sqrt(sum / double(count))) : std::nullopt;
}

std::vector<double> convolve(int width, int height, std::span<const double> plane, std::span<const double> along_x,
                             std::span<const double> along_y) {
  const auto w = std::size_t(width), h = std::size_t(height), radius_x = along_x.size() / 2,
             radius_y = along_y.size() / 2;
  std::vector<double> rows(w * h), columns(w * h), padded(w + 2 * radius_x);
  for (std::size_t y = 0; y < h; y++) {
    const auto row = plane.subspan(y * w, w);
    std::fill_n(padded.begin(), radius_x, row.front());
    std::ranges::copy(row, padded.begin() + std::ptrdiff_t(radius_x));
    std::fill_n(padded.end() - std::ptrdiff_t(radius_x), radius_x, row.back());
    for (std::size_t k = 0; k < along_x.size(); k++)
      add_scaled(along_x[k], std::span(padded).subspan(k, w), std::span(rows).subspan(y * w, w));
  }
  for (std::size_t y = 0; y < h; y++)
    for (std::size_t k = 0; k < along_y.size(); k++) {
      const std::size_t from = std::min(y + k < radius_y ? 0 : y + k - radius_y, h - 1);
      add_scaled(along_y[k], std::span(rows).subspan(from * w, w), std::span(columns).subspan(y * w, w));
    }
  return columns;
}

std::vector<double> gaussian_kernel(double sigma, int radius) {
  std::vector<double> weights;
  double sum = 0;
  for (int x = -radius; x <= radius; x++) {
    weights.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
    sum += weights.back();
  }
  for (auto& weight : weights) weight /= sum;
  return weights;
}

// Flicker: pixels followed one frame back.

namespace {

/// The pixel of the previous frame that shows the surface at (x, y); none if it does not count.
std::optional<std::size_t> earlier_place(const ErrorFrame& previous, const ErrorFrame& here, int x, int y) {
  const std::size_t i = std::size_t(y) * std::size_t(here.width) + std::size_t(x);
  double earlier_x = x, earlier_y = y;
  if (!here.motion_x.empty()) {
    earlier_x = std::round(x + double(here.motion_x[i]));
    earlier_y = std::round(y - double(here.motion_y[i]));
  }
  if (!(earlier_x >= 0 && earlier_x < here.width && earlier_y >= 0 && earlier_y < here.height)) return std::nullopt;
  const std::size_t earlier = std::size_t(earlier_y) * std::size_t(here.width) + std::size_t(earlier_x);
  if (!previous.mask[earlier]) return std::nullopt;
  if (!here.depth.empty() && !previous.depth.empty()) {
    const double a = here.depth[i], b = previous.depth[earlier];
    if (!(std::abs(a - b) <= kDepthStep * std::min(a, b))) return std::nullopt;
  }
  return earlier;
}

}  // namespace

void Flicker::add(const ErrorFrame& previous, const ErrorFrame& here) {
  const std::size_t pixels = here.mask.size();
  for (int y = 0; y < here.height; y++)
    for (int x = 0; x < here.width; x++) {
      const std::size_t i = std::size_t(y) * std::size_t(here.width) + std::size_t(x);
      if (!here.mask[i]) continue;
      const auto earlier = earlier_place(previous, here, x, y);
      if (!earlier) continue;
      for (std::size_t plane = 0; plane < here.error.size(); plane += pixels) {
        const double a = double(here.error[plane + i]) - previous.error[plane + *earlier];
        const double b =
            here.error_b.empty() ? a : double(here.error_b[plane + i]) - previous.error_b[plane + *earlier];
        square_ += a * b;
        count_++;
      }
    }
}

double Flicker::rms() const { return count_ ? std::sqrt(std::max(0.0, square_ / double(count_))) : 0; }

}  // namespace alcove
