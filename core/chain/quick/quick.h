// The quick search of sites, with fewer rules than `horizon`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/estimate/estimate.h"

namespace alcove {

/// Whether a frame is searched quickly: the settings ask for it, and for nothing that it cannot do. Several radii, a
/// falloff, a given thickness, surfaces that are not completed everywhere, a uniform density, moments,
/// curvature, hidden surfaces, and surfaces that are no occluders are left to the usual search.
bool searches_quickly(const EstimatorSettings& settings, const GBuffer& gbuffer, uint order, bool with_curvature);

/// Depth with a margin about the image, into which surfaces go on: see margin.comp. sites() fills its middle.
const gpu::Buffer& margin(gpu::Recorder& gpu, const GBuffer& gbuffer);
/// The visibility of the sites.
Estimate quick_horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const gpu::Buffer& wide,
                       const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
