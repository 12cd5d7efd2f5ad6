// Frames in flight: while one is computed, others are read and written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "core/run/frame_run.h"
#include "core/run/lanes.h"

namespace alcove {

/// Who follows the frames of a pipeline.
struct PipelineWatch {
  /// Whether a report is the last: no frame is begun after it. Called by any thread.
  std::function<bool(const FrameReport&)> ends;
  /// Takes the reports in the order of the frames, on the thread that runs the pipeline. While it waits, for a terminal
  /// that stands still, say, frames go on.
  std::function<void(FrameReport&&)> tell;
  /// Told about once a second how far the frames in flight are, on the same thread; may be empty.
  std::function<void(std::span<const FrameProgress>)> working = {};
};

/// Runs the frames on the lanes, in any order. Where the device has no memory for a frame, the number of lanes is
/// halved, down to one, and then the window that is computed at once; the frame is computed again, and says so in a
/// note. Later frames begin with what is left then.
void run_pipeline(Lanes& lanes, const RunContext& run, const Room& room, std::span<const int> frames,
                  const PipelineWatch& watch);

}  // namespace alcove
