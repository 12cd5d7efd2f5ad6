// One frame of a run: read, computed and written, whole or in tiles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "core/base/stopwatch.h"
#include "core/chain/reuse.h"
#include "core/formats/color.h"
#include "core/run/estimate_slots.h"
#include "core/run/frame_files.h"
#include "core/run/plan.h"
#include "core/run/resume.h"
#include "core/run/run_report.h"
#include "core/run/shot.h"
#include "core/run/tiles.h"

namespace alcove {

/// What all frames of a run have in common.
struct RunContext {
  const FramePlan& plan;
  InputIdentities& identities;                  // of the plan
  const FrameSource* settled = nullptr;         // all frames are read as this one; null: each by itself
  const DisplayTransform* transform = nullptr;  // for the preview of a composite
  SharedFrames* shot = nullptr;                 // where frames take anything from others
  bool takes_means = false;                     // a frame is the mean of many estimates
  Provenance provenance;                        // of settings whose camera file is the same for all frames
  std::function<bool()> stop = {};              // asked between steps: true drops the frame
};

/// Where one frame after the other is computed: its buffers, and what they still hold.
struct Lane {
  explicit Lane(gpu::Device& device) : gpu(device) {}

  gpu::Recorder gpu;
  LastFrame last;
  EstimateSlots estimates;
};

/// Told which part of how many of a frame is computed, and which share of that part is done, 0 to 1.
using PartWatch = std::function<void(int part, int parts, double done)>;

/// Reads, computes and writes one frame within the room. Never fails: what went wrong is in the report.
FrameReport run_frame(Lane& lane, const RunContext& run, const Room& room, int frame, const PartWatch& watch);

}  // namespace alcove
