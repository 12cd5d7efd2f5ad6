// How far the AO can be trusted: the distance between two estimates that bracket it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/geometry/geometry.h"

namespace alcove {

/// The settings of the estimates by slices and steps at full resolution between which --aov confidence takes the AO to
/// lie, whatever estimates it.
EstimatorSettings bracket_of(const EstimatorSettings& settings);

/// Makes a plane in [0, 1], for the largest radius, whatever the estimator: see confidence.comp.
gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings);

}  // namespace alcove
