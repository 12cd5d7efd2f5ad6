// Adds up what the parts of a frame took and what was found in them, for the frame's report.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/chain/chain.h"
#include "core/frame/gbuffer.h"
#include "core/frame/scale_notes.h"
#include "core/run/run_report.h"

namespace alcove {

/// Counts over all windows of one frame. What the windows share is counted in each.
class FrameTally {
 public:
  explicit FrameTally(FrameReport& report) : report_(report) {}

  /// A window is about to be computed.
  void begin(const Window& computed);
  void add_inputs(const FrameInputs& inputs) {
    sample_.add(inputs.view, inputs.depth_map, inputs.depth_precision, inputs[RawPlane::depth]->as<float>());
  }
  void add_passes(std::span<const gpu::PassTime> passes);
  /// is_same: all results were kept from the frame before.
  void add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same);

  /// Writes the sums into the report, and what the user should know.
  void finish(const FrameSource& source, const Settings& settings);

 private:
  /// How many pixels have had an estimate; where each has its own, how many surfaces ask for one.
  double estimates_of(const EstimatorSettings& settings) const;
  void note_repairs();
  void note_missing(const FrameSource& source);

  FrameReport& report_;
  FrameCounts counts_{};
  DepthSample sample_;
  bool has_ao_ = false;
};

}  // namespace alcove
