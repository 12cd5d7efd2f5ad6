// Adds up what the parts of a frame took and what was found in them, for the frame's report.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/chain/chain.h"
#include "core/frame/behind.h"
#include "core/frame/gbuffer.h"
#include "core/frame/scale_notes.h"
#include "core/run/run_report.h"
#include "core/run/shot.h"

namespace alcove {

/// Counts over all windows of one frame. What the windows share is counted in each.
class FrameTally {
 public:
  explicit FrameTally(FrameReport& report) : report_(report) {}

  /// A window is about to be computed.
  void begin(const Window& computed);
  /// What was read of that window, source.data; `written` is all that is written of the frame.
  void add_inputs(const FrameSource& source, const FrameInputs& inputs, const Window& written);
  /// What preparing others took comes before the passes of the frame.
  void add_others(const PreparedOthers& took);
  /// What the frame's own estimate found, where it is a mean of many; `others`: that the frame itself takes beside it.
  void add_estimate(const FrameReport& estimate, const Others& others);
  void add_passes(std::span<const gpu::PassTime> passes);
  /// is_same: all results were kept from the frame before.
  void add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same);

  /// What the user should know before the frame is computed.
  static Notes notes_on(const FrameSource& source);

  /// Writes the sums into the report, and what the user should know. Fails with ErrorKind::input where the pixels show
  /// that a layer of hidden surfaces cannot be one.
  void finish(const FrameSource& source, const Settings& settings);

 private:
  /// How many pixels have had an estimate; where each has its own, how many surfaces ask for one.
  double estimates_of(const EstimatorSettings& settings) const;
  void note_repairs(const FrameSource& source);
  void add(const gpu::PassTime& pass, gpu::PassTime& sum);

  FrameReport& report_;
  FrameCounts counts_{};
  DepthSample sample_;
  BehindSample behind_;
  std::uint64_t rows_of_others_ = 0;
  std::size_t before_ = 0;  // passes that prepared others
  bool has_ao_ = false;
};

}  // namespace alcove
