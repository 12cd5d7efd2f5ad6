// The pass that draws what the others see.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/estimate/sites.h"
#include "core/chain/geometry/geometry.h"
#include "core/chain/results/debug_view.h"
#include "core/chain/results/outputs.h"

namespace alcove {

/// The visibility on its way, at the resolution of the estimate; null where there is none.
struct DebugStages {
  GBuffer gbuffer{};
  const gpu::Buffer* raw_ao = nullptr;
  Sites sites{};  // the pixels that raw_ao is of
  const gpu::Buffer* denoised_ao = nullptr;
  const gpu::Buffer* completed = nullptr;  // of the pixels of raw_ao; null: not asked for
  const gpu::Buffer* kinds = nullptr;      // of the tiles
  const gpu::Buffer* count = nullptr;      // of the frame's pixels: of how many frames' estimates each is the mean
};
DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame);

}  // namespace alcove
