// Frames that show nothing but sky: what the chain would give, without a kernel.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/chain/aov.h"
#include "core/chain/frame_inputs.h"

namespace alcove {

/// Whether the frame is sky, and nothing is wanted of it but its visibility.
bool is_open_sky(const FrameInputs& frame, const EstimatorSettings& settings, const Wanted& wanted);

/// Counts, and a visibility of 1.
FrameOutputs open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
