// The order of the passes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/base/frame_inputs.h"
#include "core/chain/results/outputs.h"

namespace alcove {

/// Records the passes that make what is wanted of one frame, and the composite where the frame has a beauty.
/// settings.radius must be set where they need AO.
FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                       const Wanted& wanted = {});

}  // namespace alcove
