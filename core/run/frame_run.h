// One frame of a run: read, computed and written, whole or in tiles; and the sums over its parts.
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
#include "core/run/frame_files.h"
#include "core/run/lanes.h"
#include "core/run/plan.h"
#include "core/run/resume.h"
#include "core/run/run_preview.h"
#include "core/run/run_report.h"
#include "core/run/shot.h"
#include "core/run/tiles.h"

namespace alcove {

/// Counts over all windows of one frame. Pixels that windows share count in each.
class FrameTally {
 public:
  explicit FrameTally(FrameReport& report) : report_(report) {}

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

  /// The notes on the frame before it is computed.
  static Notes notes_on(const FrameSource& source, const InputSettings& settings);

  /// Writes the sums and the notes into the report. Fails with ErrorKind::input where the pixels show
  /// that a layer of hidden surfaces cannot be one.
  void finish(const FrameSource& source, const Settings& settings);

 private:
  /// The number of pixels with an estimate; if each has its own, of pixels that show surfaces.
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

/// The device time of a look; the sum is that of a run with it alone.
struct LookTime {
  double estimate_ms = 0;  // of the passes that all looks share, and of other frames
  double own_ms = 0;
};
/// Takes the results of the look of that number, over a window.
using TakeLook =
    std::function<void(std::size_t look, FrameSource&, const Window&, const FrameOutputs&, const LookTime&)>;

/// The common state of all frames of a run.
struct RunContext {
  RunPreview& look;
  const FramePlan& plan;
  InputIdentities& identities;                  // of the plan
  const FrameSource* settled = nullptr;         // all frames are read as this one; null: each by itself
  const DisplayTransform* transform = nullptr;  // for the preview of a composite
  SharedFrames* shot = nullptr;                 // if frames use others
  bool takes_means = false;                     // frames are averaged
  Provenance provenance;                        // of settings whose camera file is the same for all frames
  std::function<bool()> stop = {};              // asked between steps: true drops the frame
  // Takes the preview of a frame instead of its file; may be empty. Any thread calls it.
  std::function<void(int frame, const ShownPicture&)> take_preview = {};
  // Looks that take_look receives one after the other, instead of files, of a frame that is computed at once. They
  // differ from the plan's settings in the shaping and the composite's look alone, so one estimate serves all. A frame
  // that is tried again delivers them again.
  std::vector<Settings> looks = {};
  TakeLook take_look = {};
  ReadPlanes* planes = nullptr;  // of the only frame, from run to run; null: they are read
};

/// The report of a frame before any work.
FrameReport report_of(const FramePlan& plan, int frame);

/// Called with the part that is computed, the number of parts, and the share of that part that is done, 0 to 1.
using PartWatch = std::function<void(int part, int parts, double done)>;

/// Reads, computes and writes one frame on a lane, within the room. Never throws: the report has the error.
FrameReport run_frame(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, int frame,
                      const PartWatch& watch);

}  // namespace alcove
