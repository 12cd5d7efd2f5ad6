// The sums over the parts of a frame, and the sentences of its report.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/chain/chain.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/radius.h"
#include "core/run/neighbours.h"
#include "core/run/run_report.h"

namespace alcove {

/// Counts over all windows of one frame. A pixel of several windows counts in each of them.
class FrameTally {
 public:
  /// `taker`: the tally of the frame that this one is estimated for. Windows count there, too. Null: the frame is
  /// computed for itself.
  explicit FrameTally(FrameReport& report, FrameTally* taker = nullptr) : report_(report), taker_(taker) {}

  /// A window is about to be computed.
  void begin(const Window& computed);
  /// The planes read for that window; `written`: the window that is written of the frame.
  void add_inputs(const FrameSource& source, const Window& computed, const FrameInputs& inputs, const Window& written);
  /// The cost of preparing others comes before the passes of the frame.
  void add_others(const PreparationCost& cost);
  /// Counts of this frame's estimate, if frames are averaged; `others`: of the other frames that it uses.
  void add_estimate(const FrameReport& estimate, const Neighbours& others);
  void add_passes(std::span<const gpu::PassTime> passes);
  /// is_same: all results were kept from the frame before.
  void add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same);
  /// Compares the composite of `part` of that window, if there is one, with its beauty, in a sample of the written
  /// pixels.
  void add_composite(const FrameSource& source, const Window& computed, const Window& part, const FrameInputs& inputs,
                     const FrameOutputs& outputs, const Window& written);

  /// The notes on the frame before it is computed.
  static Notes notes_on(const FrameSource& source, const InputSettings& settings);

  /// Writes the sums and the notes into the report. Fails with ErrorKind::input if the pixels contradict a layer of
  /// hidden surfaces.
  void finish(const FrameSource& source, const Settings& settings);

 private:
  void add_surfaces(const FrameOutputs& outputs);
  void add_errors(const FrameOutputs& outputs, const Window& computed);
  void add_lights(const FrameOutputs& outputs, const Window& computed);
  void add_work(const FrameOutputs& outputs, bool is_same);
  /// The number of pixels with an estimate of their own. If no pixels share one, these are the pixels that show
  /// surfaces.
  double estimates_of(const EstimatorSettings& settings) const;
  void note_repairs(const FrameSource& source);
  void note_dark_lights(const FrameSource& source, const LightsFile& lights);
  void note_far_lamps(const FrameSource& source, const LightsFile& lights);
  void note_negative_composite(const FrameSource& source);
  void add(const gpu::PassTime& pass, gpu::PassTime& sum);

  FrameReport& report_;
  FrameTally* const taker_;
  FrameCounts counts_{};
  std::vector<std::uint64_t> lit_;  // pixels that a light reaches, and sky; by the light
  DepthSample sample_;
  std::size_t composed_ = 0, negative_ = 0;  // sampled pixels of the composite, and those far below 0
  BehindSample behind_;
  std::uint64_t rows_of_others_ = 0;
  std::size_t before_ = 0;  // passes that prepared others
  bool has_ao_ = false, is_quick_ = false;
  bool has_alpha_ = false, has_coverage_ = false;  // of the beauty; coverage: an alpha above 0
};

}  // namespace alcove
