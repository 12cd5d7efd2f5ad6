// FLIP: the difference that a viewer sees when two images alternate.
// SPDX-License-Identifier: BSD-3-Clause
//
// P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020 (LDR-FLIP);
// P. Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021 (HDR-FLIP).
// Written from the papers' formulas. Implementations differ in the sixth digit, as single precision and filter order
// do.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace alcove {

/// Pixels per degree of the viewer's sight: the papers' default, a 0.7 m wide 4K monitor seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67;

/// Red, green, blue: planes of one size, row by row, all finite. For grey, the same plane three times.
using ColorPlanes = std::array<std::span<const float>, 3>;

/// The error of every pixel, in [0, 1], of display values (sRGB-encoded, clamped to [0, 1]). Symmetric in the two
/// images.
std::vector<float> ldr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference,
                            double pixels_per_degree = kFlipPixelsPerDegree);

/// The exposures, in stops, between which HDR-FLIP looks: from where the brightest reference pixel is just below white
/// to where the median is.
struct ExposureRange {
  double start = 0, stop = 0;
  int count = 2;  // the larger of 2 and the number of stops
};
ExposureRange hdr_flip_exposures(const ColorPlanes& reference);

/// The error of every pixel, in [0, 1], of scene-linear Rec.709 values (clamped to [0, 65536]): the largest LDR-FLIP of
/// the exposures, each after the ACES tone curve. Not symmetric: the exposures are the reference's.
std::vector<float> hdr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference,
                            double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace alcove
