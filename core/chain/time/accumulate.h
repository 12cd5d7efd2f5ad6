// The pass that takes the mean of what many frames estimate, in both directions of time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/base/frame_inputs.h"
#include "core/chain/filters/filters.h"

namespace alcove {

/// The mean of many frames.
struct Accumulation {
  Visibility visibility;
  gpu::Buffer* count = nullptr;  // a plane: how many estimates, or parts of them, a pixel is the mean of; and the sums
};

/// Finds the pixels that frames of the group may see past, or the frame past theirs: see suspects.comp. The words are
/// those of one group at a time.
const gpu::Buffer& suspects(gpu::Recorder& gpu, const EstimateSet& estimates, const SeenGroup& group);

/// Marks the cells of space near which things have moved between the frame and those of the group: see moved.comp.
/// radius: scene units; place: of the group's first frame among all others.
void moved(gpu::Recorder& gpu, const EstimateSet& estimates, const SeenGroup& group, const gpu::Buffer& suspects,
           float radius, uint place, const gpu::Buffer& near);

/// Takes the mean of the estimates, each where it sees what the G-buffer shows and nothing within the largest radius of
/// it has moved, and in part about the border of where something has. They have planes of so many radii beside the
/// visibility, and moments of that order.
Accumulation accumulate(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimateSet& estimates,
                        const EstimatorSettings& settings, std::size_t scales, uint order, bool with_curvature = false);

}  // namespace alcove
