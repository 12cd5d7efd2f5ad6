// Frames in flight: while one is computed, others are read and written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "core/run/frame_run.h"
#include "core/run/lanes.h"

namespace alcove {

/// Takes the report of a frame. While it waits, for a terminal that stands still, say, frames go on.
using TakeReport = std::function<void(FrameReport&&)>;
/// Told about once a second how far the frames in flight are; may be empty.
using TakeProgress = std::function<void(std::span<const FrameProgress>)>;

/// Runs the frames on the lanes, in any order, until one fails that ends the run; calls both functions on this thread,
/// the first in the order of the frames. Where the device has no memory for a frame, the number of lanes is halved,
/// down to one, and then the window that is computed at once; the frame is computed again, and says so in a note. Later
/// frames begin with what is left then.
void run_pipeline(Lanes& lanes, const RunContext& run, const Room& room, std::span<const int> frames,
                  const TakeReport& take_report, const TakeProgress& take_progress);

}  // namespace alcove
