// Frames that show nothing but sky: the host fills in the chain's results, without a kernel.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/base/frame_inputs.h"
#include "core/chain/results/outputs.h"

namespace alcove {

/// Whether the frame is nothing but sky, and nothing but its visibility is wanted.
bool is_open_sky(const FrameInputs& frame, const EstimatorSettings& settings, const Wanted& wanted);

/// Gives the counts, and a visibility of 1.
FrameOutputs open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
