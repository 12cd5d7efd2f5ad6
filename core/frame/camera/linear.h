// Vectors and matrices of three, and least squares by normal equations.
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

using Vector3 = std::array<double, 3>;
/// Rows of a rotation (or any linear map): to = M * from.
using Matrix3 = std::array<Vector3, 3>;

inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector3 sum(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 scaled(const Vector3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double length(const Vector3& a) { return std::sqrt(dot(a, a)); }

inline Vector3 times(const Matrix3& m, const Vector3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
inline Matrix3 transposed(const Matrix3& m) {
  return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
}
inline Matrix3 product(const Matrix3& a, const Matrix3& b) {
  Matrix3 result{};
  for (std::size_t i = 0; i < 3; i++)
    for (std::size_t j = 0; j < 3; j++)
      for (std::size_t k = 0; k < 3; k++) result[i][j] += a[i][k] * b[k][j];
  return result;
}
/// Below 0 where the map mirrors.
inline double determinant(const Matrix3& m) { return dot(m[0], cross(m[1], m[2])); }
/// The scale, squared, of a map that turns, may mirror, and scales all directions alike; none of any other.
inline std::optional<double> squared_scale(const Matrix3& m) {
  constexpr double kTolerance = 1e-3;  // since matrices come from single precision, and from tools that round
  const double squared = dot(m[0], m[0]);
  for (std::size_t a = 0; a < 3; a++)
    for (std::size_t b = 0; b < 3; b++)
      if (!(squared > 0) || !(std::abs(dot(m[a], m[b]) / squared - (a == b)) < kTolerance)) return std::nullopt;
  return squared;
}

// Least squares.

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
