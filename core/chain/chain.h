// The order of the passes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/base/frame_inputs.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/geometry/geometry.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"

namespace alcove {

/// The G-buffers of a frame.
struct Surfaces {
  GBuffer frame;
  GBuffer wide;  // with the margin that other frames and views fill; else the same
};

/// The surfaces of a frame, the visibility of its pixels, and the stages before it; null: not asked for. The buffers
/// keep their contents while the recorder records results alone.
struct FrameVisibility {
  Surfaces surfaces;
  Visibility visibility;  // before any shaping
  Matte matte;
  Estimate estimate;  // of its own; none of a mean over frames
  gpu::Buffer* completion = nullptr;
  gpu::Buffer* error = nullptr;  // of the frame's pixels
  gpu::Buffer* count = nullptr;  // of a mean: a plane of the number of averaged frames of each pixel
  DebugStages stages;
  bool is_quick = false;  // by the quick search
};

/// Records the passes up to the visibility. settings.radius must be set where it is needed.
FrameVisibility frame_visibility(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                                 const Wanted& wanted);

/// Records the remaining passes, in the same recording or in later ones. The settings may differ from those of
/// frame_visibility() in the shaping and the composite's look alone. Repairs count each time.
FrameOutputs results_of(gpu::Recorder& gpu, const FrameInputs& frame, const FrameVisibility& visible,
                        const EstimatorSettings& settings, const Wanted& wanted);

/// Records the passes for the wanted outputs of one frame, and the composite if the frame has a beauty.
/// settings.radius must be set where they need AO.
FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                       const Wanted& wanted = {});

}  // namespace alcove
