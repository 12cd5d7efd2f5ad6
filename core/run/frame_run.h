// One frame of a run: read, computed and written, whole or in tiles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "core/base/stopwatch.h"
#include "core/chain/reuse.h"
#include "core/formats/color.h"
#include "core/run/frame_files.h"
#include "core/run/plan.h"
#include "core/run/run_report.h"
#include "core/run/tiles.h"

namespace alcove {

/// What all frames of a run have in common.
struct RunContext {
  const FramePlan& plan;
  const FrameSource* settled = nullptr;         // as which all frames are read; null: each by itself
  const DisplayTransform* transform = nullptr;  // for the preview of a composite
  Provenance provenance;                        // of settings without a camera file a frame
  Room room;                                    // for this frame
  std::function<bool()> stop = {};              // asked between steps: true drops the frame
};

/// Where one frame after the other is computed: buffers, and what they still hold.
struct Lane {
  explicit Lane(gpu::Device& device) : gpu(device) {}

  gpu::Recorder gpu;
  LastFrame last;
};

/// Never fails: what went wrong is in the report.
FrameReport run_frame(Lane& lane, const RunContext& run, int frame);

}  // namespace alcove
