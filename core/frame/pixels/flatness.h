// Flat surfaces as the measure of the meaning of depth values, and the coarseness of the values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// Finds the common divisor of the differences between neighbouring values, at three places of their distribution.
/// Values of some 17 bits or fewer have a step; `sky`: values at or beyond it count for none. A few values alone tell
/// nothing of an orthographic view, where they may be stairs from above.
Grain grain_of(std::span<const float> raw, double sky, bool orthographic = false);

/// Scores planar, ray and inverse depth, the best first. Inverse stands for all that is affine in 1/z, as device depth
/// is. In an orthographic view planar stands for ray and device depth too, and inverse for itself. Gives nothing where
/// too little of the frame is smooth. `sky`: values at or beyond it, and 0, are no surface.
///
/// On a plane 1/z is affine over the image (orthographic: z). Over each block a polynomial of second degree is fitted
/// to the quantity that would be affine by each kind. A block is flat by the kind whose second-degree terms vanish
/// within the block's own noise: its residual, and the step of the values. So neither rounding nor samples beside the
/// pixels' centres speak for a kind. If two kinds are flat, the block does not tell.
///
/// The curve is that of the blocks that show planes, whatever the kind.
struct DepthShape {
  std::vector<DepthScore> scores;
  Curve curve;
};
DepthShape shape_of(std::span<const float> raw, const View& view, double sky, const Grain& grain);

/// Gives the noise of flat surfaces whose pixels show places beside their centres: the standard deviation of depth,
/// relative to its change from one pixel to the next. A random place within each pixel gives 0.29, the mean of n of
/// them 0.29 / sqrt(n). Gives none if the flat surfaces are exact, or if the noise does not follow the slope. `grain`
/// is that of the raw values.
std::optional<double> jitter_of(std::span<const float> raw, const DepthMap& map, const View& view, const Grain& grain);

}  // namespace alcove
