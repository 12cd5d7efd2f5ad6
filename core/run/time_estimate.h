// How long a run will take, by a part of its first frame that is computed to find out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/run/frame_files.h"
#include "core/run/plan.h"

namespace alcove {

/// A run that is to be estimated.
struct TimedRun {
  const FramePlan& plan;
  const Settings& settings;        // of all frames: names may be patterns
  const std::vector<int>& frames;  // to compute
};

/// Computes more and more of a frame, up to all of it, until that takes long enough to be told from noise, and says
/// how long the run will take by that: "about 2 min: ...". It takes a few seconds at most, and the time of a few
/// frames more where frames take from others; it writes nothing that stays. Where nothing can be computed, it says why
/// the time is unknown.
std::string time_text(const TimedRun& run);

}  // namespace alcove
