// The pass that averages the estimates of many frames, before and after.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/base/frame_inputs.h"
#include "core/chain/filters/filters.h"

namespace alcove {

/// The mean of many frames.
struct Accumulation {
  Visibility visibility;
  gpu::Buffer* count = nullptr;  // a plane: the number of averaged estimates, or of parts of them; and the sums
};

/// Finds pixels of the frame that frames of the group may see past, and the other way round: see suspects.comp. The
/// words serve one group at a time.
const gpu::Buffer& suspects(gpu::Recorder& gpu, const EstimateSet& estimates, const SeenGroup& group);

/// Marks the cells of space near movement between the frame and the group's frames: see moved.comp. radius: scene
/// units; place: of the group's first frame among all others.
void moved(gpu::Recorder& gpu, const EstimateSet& estimates, const SeenGroup& group, const gpu::Buffer& suspects,
           float radius, uint place, const gpu::Buffer& near);

/// Averages the estimates. One counts at a pixel if it shows the same point and nothing within the largest radius has
/// moved; around movement it fades. They have planes of so many radii beside the visibility, and moments of that order.
Accumulation accumulate(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimateSet& estimates,
                        const EstimatorSettings& settings, std::size_t scales, uint order, bool with_curvature = false);

}  // namespace alcove
