// A run: frames from files to files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <string>

#include "core/base/settings.h"
#include "core/run/first_look.h"
#include "core/run/run_report.h"

namespace alcove {

/// Who follows a run; each may be empty.
struct RunWatch {
  // Called before the first frame with the run as it is known then, and with the number of its frames.
  std::function<void(const RunReport&, int)> begin;
  // Called where RunReport::notes has grown since.
  std::function<void(const RunReport&)> noted;
  // Called for one frame after the other, in their order. Frames that a lost device took with it come later.
  std::function<void(const FrameReport&)> frame;
  // Asked by any thread. Once it is true no frame is begun, and those in flight are dropped before their next step.
  std::function<bool()> stop;
  // Called about once a second, between calls of frame(), with the frames in flight.
  std::function<void(std::span<const FrameProgress>)> working = {};
};

/// Computes the frames of a run and writes their outputs. After the loss of its device it goes on with a
/// fresh one, once. Fails on what is wrong before the first frame. What is wrong with a frame is in its report, and
/// ends the run unless the settings say to keep going.
RunReport run_frames(FirstLook& look, const RunWatch& watch);

}  // namespace alcove
