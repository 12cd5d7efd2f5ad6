// Frames in flight: while one is computed, others are read and written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "core/run/frame_run.h"

namespace alcove {

/// Takes the report of a frame. If the call blocks, as on a stopped terminal, the frames go on.
using TakeReport = std::function<void(FrameReport&&)>;
/// Called about once a second with the progress of the frames in flight; may be empty.
using TakeProgress = std::function<void(std::span<const FrameProgress>)>;

/// Runs the frames on the lanes, in any order, until a failure ends the run. Calls both functions on this thread, and
/// the first one in the order of the frames. If the device has no memory for a frame, the number of lanes is halved. If
/// there is only one lane, the window that is computed at once is halved. The frame is then computed again, with a
/// note. Later frames keep these limits.
void run_pipeline(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, std::span<const int> frames,
                  const TakeReport& take_report, const TakeProgress& take_progress);

}  // namespace alcove
