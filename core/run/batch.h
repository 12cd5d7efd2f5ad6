// A run: frames from files to files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "core/base/settings.h"
#include "core/run/run_report.h"

namespace alcove {

/// Who follows a run; each may be empty.
struct RunWatch {
  // before the first frame: the run as it is known then, and how many frames it has
  std::function<void(const RunReport&, int)> begin;
  // one frame after the other, in their order; those of a device that was lost come once more, later
  std::function<void(const FrameReport&)> frame;
  // true: no frame is begun any more, and those in flight are dropped before their next step
  std::function<bool()> stop;
};

/// Computes the frames that the settings name and writes their outputs. After the loss of its device it goes on with a
/// fresh one, once. Fails on what is wrong before the first of them; what is wrong with a frame is in its report, and
/// ends the run unless the settings say to keep going.
RunReport run_frames(const Settings& settings, const RunWatch& watch = {});

}  // namespace alcove
