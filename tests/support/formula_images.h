// Pictures made by whole-number formulas, so that a program in another language makes the same bits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <vector>

namespace alcove::test {

constexpr int kFormulaWidth = 48, kFormulaHeight = 40;

/// ((a x^2 + b y^2 + c x y) mod m) / (m - 1): smooth in places, noise in others.
inline std::vector<float> formula_plane(int a, int b, int c, int m) {
  std::vector<float> plane;
  for (int y = 0; y < kFormulaHeight; y++)
    for (int x = 0; x < kFormulaWidth; x++)
      plane.push_back(float(double((x * x * a + y * y * b + x * y * c) % m) / (m - 1)));
  return plane;
}

/// Clamped (k x + 2 y + d) / (48 k + 80): a ramp.
inline std::vector<float> ramp_plane(int d, int k) {
  std::vector<float> plane;
  for (int y = 0; y < kFormulaHeight; y++)
    for (int x = 0; x < kFormulaWidth; x++)
      plane.push_back(
          float(std::clamp(double(x * k + 2 * y + d) / (kFormulaWidth * k + 2 * kFormulaHeight), 0.0, 1.0)));
  return plane;
}

/// A ramp with a box of 0.9 in columns 15 to 29 and rows 10 to 19.
inline std::vector<float> ramp_with_box() {
  auto plane = ramp_plane(0, 1);
  for (int y = 10; y < 20; y++) std::fill_n(plane.begin() + y * kFormulaWidth + 15, 15, 0.9f);
  return plane;
}

using ColorImage = std::array<std::vector<float>, 3>;
inline ColorImage noise_reference() {
  return {formula_plane(1, 3, 1, 256), formula_plane(2, 1, 3, 200), formula_plane(1, 1, 5, 300)};
}
inline ColorImage noise_result() {
  return {formula_plane(1, 3, 2, 256), formula_plane(2, 1, 3, 210), formula_plane(1, 2, 5, 300)};
}

}  // namespace alcove::test
