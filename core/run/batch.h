// A run: frames from files to files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "core/run/run_preview.h"
#include "core/run/run_report.h"

namespace alcove {

/// Callbacks of a run; each may be empty.
struct RunWatch {
  // Called before the first frame, with the report so far and the number of frames.
  std::function<void(const RunReport&, int)> begin;
  // Called when RunReport::notes has grown.
  std::function<void(const RunReport&)> noted;
  // Called for each frame, in order. The frames of a lost device come later.
  std::function<void(const FrameReport&)> frame;
  // Any thread may call it. Once it returns true, no frame begins. Frames in flight stop before their next step.
  std::function<bool()> stop;
  // Called about once a second, between calls of frame(), with the frames in flight.
  std::function<void(std::span<const FrameProgress>)> working = {};
};

/// Computes the frames of a run and writes their outputs. Replaces a lost device by a fresh one, once. Fails on an
/// error before the first frame. The report of a frame has the frame's error. Such an error ends the run, unless the
/// settings say to keep going.
RunReport run_frames(RunPreview& look, const RunWatch& watch);

}  // namespace alcove
