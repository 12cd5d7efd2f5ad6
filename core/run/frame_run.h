// One frame of a run: read, computed and written, whole or in tiles. And many, on lanes: each computes one frame after
// the other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/chain/reuse.h"
#include "core/formats/color.h"
#include "core/frame/find/frame_source.h"
#include "core/gpu/recorder.h"
#include "core/run/estimates.h"
#include "core/run/frame_files.h"
#include "core/run/memory.h"
#include "core/run/plan.h"
#include "core/run/resume.h"
#include "core/run/run_preview.h"
#include "core/run/run_report.h"

namespace alcove {

/// The buffers of one frame after the other, and their contents from the frame before.
struct Lane {
  explicit Lane(gpu::Device& device) : gpu(device) {}

  gpu::Recorder gpu;
  LastFrame last;
  EstimateSlots estimates;
};

/// One lane for each frame in flight. A lane keeps its buffers from frame to frame. On a CPU each lane has a device of
/// its own, so that every frame has a core from its first byte to its last. A GPU is shared by all lanes.
class Lanes {
  struct Place {
    gpu::Device* device;
    std::unique_ptr<Lane> lane;  // null: without buffers
  };

 public:
  Lanes(const gpu::DeviceOptions& options, int count);

  gpu::Device& device() { return *devices_.front(); }
  int count() const;
  int validation_messages() const;

  /// Changes the number of lanes. Idle lanes release their buffers.
  void set_count(int count);

  /// Exclusive use of a lane. At most count() threads may have one at once.
  class Lease {
   public:
    explicit Lease(Lanes& lanes);
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();

    Lane& lane() { return *place_.lane; }
    /// Keeps the lane's buffers for the next frame. Without this call, the end of the lease releases the buffers.
    void keep_buffers() { keeps_buffers_ = true; }

   private:
    Lanes& lanes_;
    Place place_;
    bool keeps_buffers_ = false;
  };

 private:
  Place take();
  void give_back(Place place);

  gpu::DeviceOptions options_;
  int count_;
  mutable std::mutex mutex_;  // of all that may change
  std::vector<std::unique_ptr<gpu::Device>> devices_;
  std::vector<Place> free_;
  bool is_first_taken_ = false;
};

/// The device time of a look. The sum is the time of a run with this look alone.
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
  // The looks of a frame that is computed at once. take_look receives one after the other, and no file is written.
  // Looks differ from the plan's settings in the shaping and the composite's look alone, so one estimate serves all
  // looks. If a frame is tried again, take_look receives all looks again.
  std::vector<Settings> looks = {};
  TakeLook take_look = {};
  ReadPlanes* planes = nullptr;  // of the only frame, from run to run; null: they are read
};

/// The report of a frame before any work.
FrameReport report_of(const FramePlan& plan, int frame);

/// Called with the number of the part in work, the number of parts, and the part's share of work that is done, 0 to 1.
using PartWatch = std::function<void(int part, int parts, double done)>;

/// Estimates a frame for the frames around it. Fails as open_frame() does, and with ErrorKind::input if the position of
/// the frame's camera is unknown.
EstimatedFrame estimate_frame(Lane& lane, const RunContext& run, const MemoryBudget& budget, int frame,
                              PreparationCost& cost);

/// Reads, computes and writes one frame on a lane, within the budget. Never throws: the report has the error.
FrameReport run_frame(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, int frame,
                      const PartWatch& watch);

// Frames in flight: while one is computed, others are read and written.

/// Takes the report of a frame. If the call blocks, as on a stopped terminal, the frames go on.
using TakeReport = std::function<void(FrameReport&&)>;
/// Called about once a second with the progress of the frames in flight; may be empty.
using TakeProgress = std::function<void(std::span<const FrameProgress>)>;

/// Runs the frames on the lanes, in any order, until a failure ends the run. Calls both functions on this thread, and
/// the first one in the order of the frames. If the device has no memory for a frame, the number of lanes is halved. If
/// there is only one lane, the window that is computed at once is halved. The frame is then computed again, with a
/// note. Later frames keep these limits.
void run_pipeline(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, std::span<const int> frames,
                  const TakeReport& take_report, const TakeProgress& take_progress);

}  // namespace alcove
