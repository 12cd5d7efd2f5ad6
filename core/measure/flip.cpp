// FLIP, term by term: contrast sensitivity, colour distance, edges and points, and the exposures of the HDR variant.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace alcove {
namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;
using Plane = std::vector<double>;
using Planes = std::array<Plane, 3>;

/// The pixels per degree of the viewer's sight: the papers' default, a 0.7 m wide 4K monitor seen from 0.7 m.
constexpr double kPixelsPerDegree = 67;

// Colour.

Triple operator*(const Matrix& m, const Triple& v) {
  Triple product{};
  for (std::size_t row = 0; row < 3; row++)
    for (std::size_t column = 0; column < 3; column++) product[row] += m[row][column] * v[column];
  return product;
}

Matrix inverse(const Matrix& m) {
  Matrix result{};
  double determinant = 0;
  for (std::size_t r = 0; r < 3; r++)
    for (std::size_t c = 0; c < 3; c++) {
      const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      result[c][r] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
      if (r == 0) determinant += m[r][c] * result[c][r];
    }
  for (auto& row : result)
    for (auto& value : row) value /= determinant;
  return result;
}

/// The XYZ of a chromaticity, with Y = 1.
Triple xyz_of(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

/// The white point D65, rounded as in the FLIP papers' conversion of sRGB.
const Triple kWhite = xyz_of(0.31271, 0.32902);

/// Makes the matrix from linear Rec.709 to XYZ. The primaries are scaled so that their sum is white.
Matrix make_xyz_from_rgb() {
  const std::array<Triple, 3> primaries{xyz_of(0.64, 0.33), xyz_of(0.30, 0.60), xyz_of(0.15, 0.06)};
  Matrix columns{};
  for (std::size_t row = 0; row < 3; row++)
    for (std::size_t column = 0; column < 3; column++) columns[row][column] = primaries[column][row];
  const Triple brightness = inverse(columns) * kWhite;
  for (auto& row : columns)
    for (std::size_t column = 0; column < 3; column++) row[column] *= brightness[column];
  return columns;
}
const Matrix kXyzFromRgb = make_xyz_from_rgb();
const Matrix kRgbFromXyz = inverse(kXyzFromRgb);

double linear_from_srgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

/// The opponent colour of FLIP 2020, section 4.1: L*a*b* without its cube root, so that filtering it is linear in
/// light.
Triple opponent_from_rgb(const Triple& rgb) {
  const Triple xyz = kXyzFromRgb * rgb;
  const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Triple rgb_from_opponent(const Triple& opponent) {
  const double y = (opponent[0] + 16) / 116;
  return kRgbFromXyz * Triple{kWhite[0] * (y + opponent[1] / 500), kWhite[1] * y, kWhite[2] * (y - opponent[2] / 200)};
}

/// The L*a*b* colour with the Hunt effect: colour counts less in the dark.
Triple hunt_lab_from_rgb(const Triple& rgb) {
  const Triple xyz = kXyzFromRgb * rgb;
  const auto f = [](double t) {
    constexpr double kDelta = 6.0 / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  };
  const double x = f(xyz[0] / kWhite[0]), y = f(xyz[1] / kWhite[1]), z = f(xyz[2] / kWhite[2]);
  const double lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

double hyab(const Triple& a, const Triple& b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

// The colour term.

/// A contrast sensitivity as a sum of two Gaussians in degrees: a sqrt(pi / b) exp(-pi^2 x^2 / b) (FLIP 2020, table 1).
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic{1, 0.0047, 0, 1e-5}, kRedGreen{1, 0.0053, 0, 1e-5},
    kBlueYellow{34.1, 0.04, 13.5, 0.025};
constexpr double kWidestSensitivity = 0.04;

/// Filters a plane by a sensitivity. Both Gaussians are separable; their normalised sum is not, so it is split.
Plane filter(int width, int height, const Plane& plane, const Sensitivity& s) {
  const auto sigma_px = [&](double b) { return std::sqrt(b / 2) / std::numbers::pi * kPixelsPerDegree; };
  const int radius = int(std::ceil(3 * sigma_px(kWidestSensitivity)));
  const auto weight = [&](double a, double b) {  // the sum of the Gaussian's weights over the kernel's square
    double row = 0;
    for (int x = -radius; x <= radius; x++) row += std::exp(-0.5 * x * x / (sigma_px(b) * sigma_px(b)));
    return a * std::sqrt(std::numbers::pi / b) * row * row;
  };
  const double w1 = weight(s.a1, s.b1), w2 = weight(s.a2, s.b2);
  const auto first_kernel = gaussian_kernel(sigma_px(s.b1), radius);
  Plane filtered = convolve(width, height, plane, first_kernel, first_kernel);
  if (s.a2 == 0) return filtered;
  const auto second_kernel = gaussian_kernel(sigma_px(s.b2), radius);
  const Plane second = convolve(width, height, plane, second_kernel, second_kernel);
  for (std::size_t i = 0; i < filtered.size(); i++) filtered[i] = (w1 * filtered[i] + w2 * second[i]) / (w1 + w2);
  return filtered;
}

/// Turns opponent colours into Hunt-adjusted L*a*b* as the eye resolves it.
Planes seen_colors(int width, int height, const Planes& opponent) {
  Planes seen{filter(width, height, opponent[0], kAchromatic), filter(width, height, opponent[1], kRedGreen),
              filter(width, height, opponent[2], kBlueYellow)};
  for (std::size_t i = 0; i < seen[0].size(); i++) {
    Triple rgb = rgb_from_opponent({seen[0][i], seen[1][i], seen[2][i]});
    for (auto& value : rgb) value = std::clamp(value, 0.0, 1.0);
    const Triple lab = hunt_lab_from_rgb(rgb);
    for (std::size_t c = 0; c < 3; c++) seen[c][i] = lab[c];
  }
  return seen;
}

/// The colour error of FLIP 2020, equations 5 and 6: compresses large differences into the last 5 % of [0, 1].
double color_error(const Triple& a, const Triple& b) {
  constexpr double kExponent = 0.7, kKneeOfMaximum = 0.4, kErrorAtKnee = 0.95;
  static const double most = std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kExponent);
  const double knee = kKneeOfMaximum * most, distance = std::pow(hyab(a, b), kExponent);
  if (distance < knee) return kErrorAtKnee / knee * distance;
  return kErrorAtKnee + (distance - knee) / (most - knee) * (1 - kErrorAtKnee);
}

// The feature term.

/// Edges and points of a plane: the lengths of its smoothed first and second derivatives.
struct Features {
  Plane edge, point;
};

/// Scales positive weights to a sum of 1, and negative ones to -1.
std::vector<double> balanced(std::vector<double> weights) {
  double positive = 0, negative = 0;
  for (const double w : weights) (w > 0 ? positive : negative) += std::abs(w);
  for (auto& w : weights) w /= w > 0 ? positive : negative;
  return weights;
}

Features features_of(int width, int height, const Plane& lightness) {
  constexpr double kWidthOfEdgeDetector = 0.082;  // degrees, from the positive to the negative peak
  const double sigma = 0.5 * kWidthOfEdgeDetector * kPixelsPerDegree;
  const int radius = int(std::ceil(3 * sigma));
  const auto gaussian = gaussian_kernel(sigma, radius);
  std::vector<double> first, second;
  for (int x = -radius; const double g : gaussian) {
    first.push_back(-x * g);
    second.push_back((x * x / (sigma * sigma) - 1) * g);
    x++;
  }
  const auto length = [&](const std::vector<double>& derivative) {
    Plane x = convolve(width, height, lightness, derivative, gaussian);
    const Plane y = convolve(width, height, lightness, gaussian, derivative);
    for (std::size_t i = 0; i < x.size(); i++) x[i] = std::hypot(x[i], y[i]);
    return x;
  };
  return {length(balanced(first)), length(balanced(second))};
}

// Both terms.

/// An image as FLIP sees it.
struct Seen {
  Planes colors;
  Features features;
};

/// Makes the image that FLIP sees. `linear` makes linear values in [0, 1] of those of the image.
Seen see(int width, int height, const ColorPlanes& image, const std::function<double(float)>& linear) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  Planes opponent{Plane(pixels), Plane(pixels), Plane(pixels)};
  for (std::size_t i = 0; i < pixels; i++) {
    const Triple color = opponent_from_rgb({linear(image[0][i]), linear(image[1][i]), linear(image[2][i])});
    for (std::size_t c = 0; c < 3; c++) opponent[c][i] = color[c];
  }
  Seen seen{seen_colors(width, height, opponent), {}};
  for (auto& y : opponent[0]) y = (y + 16) / 116;
  seen.features = features_of(width, height, opponent[0]);
  return seen;
}

/// The error of a pixel by FLIP 2020, equations 9 and 10: a colour difference counts more if features differ.
double flip_at(const Seen& a, const Seen& b, std::size_t i) {
  const double color =
      color_error({a.colors[0][i], a.colors[1][i], a.colors[2][i]}, {b.colors[0][i], b.colors[1][i], b.colors[2][i]});
  const double edge = std::abs(a.features.edge[i] - b.features.edge[i]),
               point = std::abs(a.features.point[i] - b.features.point[i]);
  const double feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2);
  return std::pow(color, 1 - feature);
}

// HDR.

/// K. Narkowicz's fit of the ACES curve, with its exposure of 0.6: (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5).
constexpr double k0 = 0.36 * 2.51, k1 = 0.6 * 0.03, k3 = 0.36 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;

double tone_mapped(double x) { return std::clamp((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5), 0.0, 1.0); }

/// The x that the tone curve maps to t.
double untone_mapped(double t) {
  const double a = k0 - k3 * t, b = k1 - k4 * t, c = -k5 * t;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

/// Clamps to the range of HDR-FLIP: light is not negative, and half floats end at 65536.
double light(float value) { return std::clamp(double(value), 0.0, 65536.0); }

/// The least luminance that exposures are fitted to, so that a black reference, or one with a black half, has a finite
/// exposure.
constexpr double kLeastLuminance = 1e-5;

}  // namespace

std::vector<float> ldr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference) {
  const auto displayed = [](float value) { return linear_from_srgb(std::clamp(double(value), 0.0, 1.0)); };
  const Seen a = see(width, height, result, displayed), b = see(width, height, reference, displayed);
  std::vector<float> error(result[0].size());
  for (std::size_t i = 0; i < error.size(); i++) error[i] = float(flip_at(a, b, i));
  return error;
}

ExposureRange hdr_flip_exposures(const ColorPlanes& reference) {
  std::vector<double> luminance(reference[0].size());
  for (std::size_t i = 0; i < luminance.size(); i++)
    luminance[i] = 0.2126 * light(reference[0][i]) + 0.7152 * light(reference[1][i]) + 0.0722 * light(reference[2][i]);
  const auto middle = luminance.begin() + std::ptrdiff_t(luminance.size() / 2);
  std::ranges::nth_element(luminance, middle);
  const double median = *middle, most = *std::ranges::max_element(luminance);
  constexpr double kJustBelowWhite = 0.85;
  const double bright = untone_mapped(kJustBelowWhite);
  ExposureRange range{std::log2(bright / std::max(most, kLeastLuminance)),
                      std::log2(bright / std::max(median, kLeastLuminance)), 2};
  range.count = std::max(2, int(std::ceil(range.stop - range.start)));
  return range;
}

std::vector<float> hdr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference) {
  const ExposureRange range = hdr_flip_exposures(reference);
  std::vector<float> error(result[0].size());
  for (int step = 0; step < range.count; step++) {
    const double gain = std::exp2(range.start + (range.stop - range.start) * step / (range.count - 1));
    const auto exposed = [gain](float value) { return tone_mapped(gain * light(value)); };
    const Seen a = see(width, height, result, exposed), b = see(width, height, reference, exposed);
    for (std::size_t i = 0; i < error.size(); i++) error[i] = std::max(error[i], float(flip_at(a, b, i)));
  }
  return error;
}

}  // namespace alcove
