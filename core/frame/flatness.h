// Flat surfaces as the measure of what depth values mean: fits over blocks of pixels, and the step of the values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// How coarsely values are stored, whatever their sample type.
struct Grain {
  double median = 0;  // of the values' distances from 0; where there is a step, each of them counts once
  double step = 0;    // from one value to the next at the median; 0: as fine as floats are, or too few values to tell
  bool is_coarse = false;  // the step is more than a 2^14th of the median
  bool is_fixed = false;   // the step is the same for small and large values
  bool is_half = false;    // the steps are those of half floats, or of half floats times a scale
};
/// Finds the common divisor of the differences between neighbouring values, at three places of their distribution.
/// Values of some 17 bits or fewer have a step; `sky`: values at or beyond it count for none.
Grain grain_of(std::span<const float> raw, double sky);

/// A way to read depth and how well the frame's flat surfaces agree with it.
struct DepthScore {
  DepthKind kind;
  // The share of the smooth blocks that are flat by this kind and by no other.
  double straight = 0;
};
/// Scores planar, ray and inverse depth, the best first. Inverse stands for all that is affine in 1/z, as device depth
/// is. In an orthographic view planar stands for ray and device depth too, and inverse for itself. Gives nothing where
/// too little of the frame is smooth. `sky`: values at or beyond it, and 0, are no surface.
///
/// On a plane 1/z is affine over the image (orthographic: z). Over each block a polynomial of second degree is fitted
/// to the quantity that would be affine by each kind. A block is flat by the kind whose second-degree terms vanish
/// within the block's own noise: its residual, and the step of the values. So neither rounding nor samples beside the
/// pixels' centres speak for a kind. If two kinds are flat, the block does not tell.
std::vector<DepthScore> score_depth(std::span<const float> raw, const View& view, double sky, const Grain& grain);

/// How far flat surfaces are from flat because pixels show places beside their centres: the standard deviation of
/// depth, relative to its change from one pixel to the next. A random place within each pixel gives 0.29, the mean of n
/// of them 0.29 / sqrt(n). None if the flat surfaces are exact, or if the noise does not follow the slope.
/// `grain` is that of the raw values.
std::optional<double> jitter_of(std::span<const float> raw, const DepthMap& map, const View& view, const Grain& grain);

}  // namespace alcove
