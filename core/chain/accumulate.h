// The pass that takes the mean of what many frames estimate, in both directions of time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/filters.h"
#include "core/chain/seen_estimates.h"

namespace alcove {

/// The mean of many frames.
struct Accumulation {
  Visibility visibility;
  gpu::Buffer* count = nullptr;  // a plane: how many frames' estimates a pixel is the mean of; and the sums
};

/// Finds near which cells of space things have moved between a frame and others, once for all parts of it: see moved.h.
/// radius: scene units.
const gpu::Buffer& moved(gpu::Recorder& gpu, const EstimateSet& estimates, float radius);

/// Takes the mean of the estimates, each where it sees what the G-buffer shows and nothing within the largest radius of
/// it has moved. They have planes of so many radii beside the visibility, and open directions where `with_bent`.
Accumulation accumulate(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimateSet& estimates,
                        const EstimatorSettings& settings, std::size_t scales, bool with_bent);

}  // namespace alcove
