// Row and column passes whose inner loops run along rows.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/convolution.h"

#include <algorithm>
#include <cmath>

namespace alcove {
namespace {

/// to += weight * from.
void add_scaled(double weight, std::span<const double> from, std::span<double> to) {
  for (std::size_t i = 0; i < to.size(); i++) to[i] += weight * from[i];
}

}  // namespace

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

}  // namespace alcove
