// The shadows of lights.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/estimate/estimate.h"

namespace alcove {

/// Gives for each light of the frame a plane of the part of it that each pixel sees, 1 = lit; 0 where the surface faces
/// away, 1 for sky. Surfaces block by the rules of the settings for samples, whatever their search. `told`: as
/// Estimate::told, of this G-buffer; null: it is found here. with_confidence: as many planes more, of the confidence in
/// each, see shadow.comp.
gpu::Buffer& shadow(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                    const EstimatorSettings& settings, const gpu::Buffer* told, bool with_confidence);

}  // namespace alcove
