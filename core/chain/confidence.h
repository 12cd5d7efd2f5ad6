// How far the AO is no guess: a second estimate between two bounds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/geometry.h"

namespace alcove {

/// A plane in [0, 1], of the largest radius, whatever the estimator: see confidence.comp.
gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings);

}  // namespace alcove
