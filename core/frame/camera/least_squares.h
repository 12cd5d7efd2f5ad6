// Least squares by normal equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace alcove {

template <std::size_t N>
using Row = std::array<double, N>;
/// A symmetric matrix.
template <std::size_t N>
using Square = std::array<Row<N>, N>;

/// Adds an equation's coefficients to the normal equations: their products by each other.
template <std::size_t N>
void add_products(Square<N>& sums, const Row<N>& row) {
  for (std::size_t i = 0; i < N; i++)
    for (std::size_t j = 0; j < N; j++) sums[i][j] += row[i] * row[j];
}

template <std::size_t N>
Row<N> applied(const Square<N>& matrix, const Row<N>& to) {
  Row<N> result;
  for (std::size_t i = 0; i < N; i++) result[i] = std::inner_product(to.begin(), to.end(), matrix[i].begin(), 0.0);
  return result;
}

/// Inverse of a symmetric positive matrix; none where it is singular.
template <std::size_t N>
std::optional<Square<N>> inverse_of(Square<N> a) {
  Square<N> inverse{};
  for (std::size_t i = 0; i < N; i++) inverse[i][i] = 1;
  for (std::size_t column = 0; column < N; column++) {
    std::size_t pivot = column;
    for (std::size_t row = column; row < N; row++)
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    if (!(std::abs(a[pivot][column]) > std::numeric_limits<double>::min())) return std::nullopt;
    std::swap(a[pivot], a[column]);
    std::swap(inverse[pivot], inverse[column]);
    const double over = 1 / a[column][column];
    for (std::size_t k = 0; k < N; k++) a[column][k] *= over, inverse[column][k] *= over;
    for (std::size_t row = 0; row < N; row++) {
      const double factor = a[row][column];
      if (row == column || factor == 0) continue;
      for (std::size_t k = 0; k < N; k++)
        a[row][k] -= factor * a[column][k], inverse[row][k] -= factor * inverse[column][k];
    }
  }
  return inverse;
}

/// The coefficients of length 1 for which the sum of squares of the equations is least, by inverse iteration; no
/// numbers where the sums are none.
template <std::size_t N>
Row<N> least_squares(Square<N> sums) {
  constexpr int kSteps = 50;
  constexpr double kLittle = 1e-16;  // of the trace, as of rounding: an exact solution would leave no inverse
  double trace = 0;
  for (std::size_t i = 0; i < N; i++) trace += sums[i][i];
  for (std::size_t i = 0; i < N; i++) sums[i][i] += kLittle * trace;
  Row<N> solution;
  for (std::size_t i = 0; i < N; i++) solution[i] = 1 + double(i);
  const auto inverse = inverse_of(sums);
  if (!inverse) solution.fill(std::numeric_limits<double>::quiet_NaN());
  for (int step = 0; inverse && step < kSteps; step++) {
    solution = applied(*inverse, solution);
    const double size = std::sqrt(std::inner_product(solution.begin(), solution.end(), solution.begin(), 0.0));
    for (double& x : solution) x /= size;
  }
  return solution;
}

}  // namespace alcove
