// What fits of points to pictures share: eigenvectors of sums, and points of a size at which sums are exact.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/frame/resection.h"

namespace alcove {

/// A symmetric matrix of N x N.
template <std::size_t N>
using Square = std::array<std::array<double, N>, N>;

/// Eigenvalues, and eigenvectors as columns, by Jacobi's rotations; in no order.
template <std::size_t N>
std::pair<std::array<double, N>, Square<N>> eigen_of(Square<N> a) {
  constexpr int kSweeps = 30;
  Square<N> v{};
  for (std::size_t i = 0; i < N; i++) v[i][i] = 1;
  for (int sweep = 0; sweep < kSweeps; sweep++) {
    double beside = 0;
    for (std::size_t p = 0; p < N; p++)
      for (std::size_t q = p + 1; q < N; q++) {
        beside += std::abs(a[p][q]);
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < N; k++) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < N; k++) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = v[k][p], vq = v[k][q];
          v[k][p] = c * vp - s * vq;
          v[k][q] = s * vp + c * vq;
        }
      }
    if (beside < 1e-300) break;
  }
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; i++) values[i] = a[i][i];
  return {values, v};
}

/// The points moved and scaled to be about 1 in size, and the way back.
struct Normalized {
  std::vector<SeenPoint> points;
  Vector3 middle{};
  double size = 1;
};

Normalized normalized(std::span<const SeenPoint> points);

}  // namespace alcove
