// Confidence in the AO: by the distance between two estimates that bracket it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/geometry/geometry.h"

namespace alcove {

/// The thickness of the thinnest occluders that bracket a visibility, in radii.
inline constexpr double kThin = 0.02;

/// The settings of the two estimates, by slices and steps at full resolution, that bracket the AO of any estimator.
EstimatorSettings bracket_of(const EstimatorSettings& settings);

/// Makes a plane in [0, 1], for the largest radius and any estimator: see confidence.comp.
gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings);

}  // namespace alcove
