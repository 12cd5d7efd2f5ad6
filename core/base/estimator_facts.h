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

/// How many pixels share one estimate, at most where the density is adaptive: 1, 2, 4, 8 or 16. Where the settings
/// leave it open, it is 1 unless the bilateral denoiser gives the others theirs at full resolution. Then it is 16, or 2
/// from 5 slices on, for an adaptive density, and 4 with up to 2 slices for gtao with a uniform one.
int spacing_of(const EstimatorSettings& settings);

/// Whether surfaces that show few pixels have more estimates than spacing_of() says.
bool is_adaptive(const EstimatorSettings& settings);

/// How far the bilateral denoiser reaches to each side, in pixels of the estimate. Where the settings leave it open, it
/// is 8 if pixels share estimates, and 4 if each has its own.
int denoise_radius_of(const EstimatorSettings& settings);

/// From how far a pixel takes estimates of others, in pixels of the estimate: 0 without a denoiser. Where pixels share
/// estimates it is at least 3 px with an adaptive density, in which each pixel then has one, and 8 with a uniform one,
/// in which small surfaces may have none: these stay open.
int denoise_reach_of(const EstimatorSettings& settings);

/// The depth samples that the settings ask for at a pixel with an estimate; 0 for an exact search.
double samples_per_estimate(const EstimatorSettings& settings);

/// The settings of the estimates by slices and steps at full resolution between which --aov confidence takes the AO to
/// lie, whatever estimates it.
EstimatorSettings bracket_of(const EstimatorSettings& settings);

/// Whether the settings ask for any shaping.
bool shapes(const EstimatorSettings& settings);

}  // namespace alcove
