// Separable filters over planes, in double precision.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

namespace alcove {

/// The plane (width x height, row by row) correlated with `along_x` in its rows, then with `along_y` in its columns.
/// The kernels have an odd number of weights, the middle one for the pixel itself. Outside, the border's pixels are
/// repeated.
std::vector<double> convolve(int width, int height, std::span<const double> plane, std::span<const double> along_x,
                             std::span<const double> along_y);

/// exp(-x^2 / (2 sigma^2)) for x from -radius to radius, sum 1. Units: pixels, both above 0.
std::vector<double> gaussian_kernel(double sigma, int radius);

}  // namespace alcove
