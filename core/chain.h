// The order of the passes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/passes.h"

namespace alcove {

/// What the host reads after the recorder has run; null: not asked for.
struct FrameOutputs {
  gpu::Buffer* counts = nullptr;     // one FrameCounts
  gpu::Buffer* ao = nullptr;         // a plane: visibility in [0, 1]
  gpu::Buffer* composite = nullptr;  // the beauty's planes
};

/// Records the whole chain for one frame. settings.radius must be set.
FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings);

}  // namespace alcove
