// What follows from the estimator's settings, and what several rooms must agree on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/settings.h"

namespace alcove {

/// All radii of the settings, from the smallest on; settings.radius must be set.
std::vector<double> radii_of(const EstimatorSettings& settings);

/// Whether slices are searched by profile and exact, and not by horizon.
bool searches_exactly(const EstimatorSettings& settings);

/// Whether the estimator searches slices about the view ray, of gtao and bitmask: these find open directions too, know
/// how thick occluders are, and nothing beyond the radius blocks.
bool searches_slices(const EstimatorSettings& settings);

/// Whether surfaces are completed behind what is nearer. They are not where occluders are endless, since all that those
/// hide is blocked anyway. What goes on beyond the picture's border does not count here.
bool completes(const EstimatorSettings& settings);

/// Whether surfaces are completed anywhere, be it beyond the picture's border alone.
bool completes_anywhere(const EstimatorSettings& settings);

/// How many pixels in a row share one estimate. Where the settings leave it open, it is 4 for the estimator that this
/// was measured with, gtao, at full resolution, with so few slices that the denoiser must share them among neighbours
/// anyway; else it is 1.
int stride_of(const EstimatorSettings& settings);

/// Whether tiles are proved to be open. If not, only sky is left out.
bool proves(const EstimatorSettings& settings);

/// The depth samples that the settings ask for at a pixel of a surface, on average.
double samples_per_pixel(const EstimatorSettings& settings);

/// Whether the settings ask for any shaping.
bool shapes(const EstimatorSettings& settings);

}  // namespace alcove
