// One frame of a run: read, computed and written, whole or in tiles; and the sums of what its parts took.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "core/base/system.h"
#include "core/chain/chain.h"
#include "core/formats/color.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/radius.h"
#include "core/run/first_look.h"
#include "core/run/frame_files.h"
#include "core/run/lanes.h"
#include "core/run/plan.h"
#include "core/run/resume.h"
#include "core/run/run_report.h"
#include "core/run/shot.h"
#include "core/run/tiles.h"

namespace alcove {

/// Counts over all windows of one frame. What the windows share is counted in each.
class FrameTally {
 public:
  explicit FrameTally(FrameReport& report) : report_(report) {}

  /// A window is about to be computed.
  void begin(const Window& computed);
  /// What was read of that window; `written` is all that is written of the frame.
  void add_inputs(const FrameSource& source, const Window& computed, const FrameInputs& inputs, const Window& written);
  /// The cost of preparing others comes before the passes of the frame.
  void add_others(const PreparationCost& cost);
  /// The findings of the frame's own estimate, where it is a mean of many; `others`: those it takes beside it.
  void add_estimate(const FrameReport& estimate, const Others& others);
  void add_passes(std::span<const gpu::PassTime> passes);
  /// is_same: all results were kept from the frame before.
  void add_outputs(const FrameOutputs& outputs, const Window& computed, bool is_same);

  /// The notes on the frame before it is computed.
  static Notes notes_on(const FrameSource& source, const InputSettings& settings);

  /// Writes the sums and the notes into the report. Fails with ErrorKind::input where the pixels show
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
  bool has_ao_ = false, is_quick_ = false;
  bool has_alpha_ = false, has_coverage_ = false;  // of the beauty; coverage: an alpha above 0
};

// The frame.

/// The device time of a look: a run with it alone takes the sum.
struct LookTime {
  double estimate_ms = 0;  // of what all looks share
  double own_ms = 0;
};
/// Takes the results of the look of that number, over a window.
using TakeLook =
    std::function<void(std::size_t look, FrameSource&, const Window&, const FrameOutputs&, const LookTime&)>;

/// The common state of all frames of a run.
struct RunContext {
  FirstLook& look;
  const FramePlan& plan;
  InputIdentities& identities;                  // of the plan
  const FrameSource* settled = nullptr;         // all frames are read as this one; null: each by itself
  const DisplayTransform* transform = nullptr;  // for the preview of a composite
  SharedFrames* shot = nullptr;                 // where frames take anything from others
  bool takes_means = false;                     // a frame is the mean of many estimates
  Provenance provenance;                        // of settings whose camera file is the same for all frames
  std::function<bool()> stop = {};              // asked between steps: true drops the frame
  // Takes the preview of a frame instead of its file; may be empty. Any thread calls it.
  std::function<void(int frame, const ShownPicture&)> take_preview = {};
  // Instead of files, of a frame that is computed at once: takes the results of these settings one after the other;
  // may be empty. They differ from the plan's in the shaping and the composite's look alone, so that one estimate
  // serves them all. A frame that is tried again hands them over again.
  std::vector<Settings> looks = {};
  TakeLook take_look = {};
  ReadPlanes* planes = nullptr;  // of the only frame, from run to run; null: they are read
};

/// The report of a frame that nothing was done for yet.
FrameReport report_of(const FramePlan& plan, int frame);

/// Told which part of how many of a frame is computed, and which share of that part is done, 0 to 1.
using PartWatch = std::function<void(int part, int parts, double done)>;

/// Reads, computes and writes one frame on a lane, within the room. Never fails: the report says what went wrong.
FrameReport run_frame(Lanes& lanes, const RunContext& run, const Room& room, int frame, const PartWatch& watch);

}  // namespace alcove
