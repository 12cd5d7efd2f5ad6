// What the frames of a shot estimate, for means of many of them: every frame is estimated once for all that take it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/chain/seen_estimates.h"
#include "core/frame/gbuffer.h"
#include "core/run/frame_files.h"
#include "core/run/frames_in_work.h"
#include "core/run/plan.h"
#include "core/run/run_report.h"
#include "core/run/shot.h"
#include "core/run/tiles.h"

namespace alcove {

/// What one frame has estimated, in host memory: planes over all of it.
struct EstimatedFrame {
  int frame = 0;
  Camera camera;
  View view{};
  vec3 depth_precision{};             // of planar depth: see DepthPrecision
  std::vector<float> depth;           // see TakenFrame
  bool has_moving = false;            // some depth is below 0
  std::vector<std::uint32_t> normal;  // the same
  std::vector<float> values;          // planes: see EstimateSet
  FrameReport report;                 // what its estimate took and found
  Others others;                      // the names of those that it takes what is hidden from
};

/// The estimates that a frame is the mean of, its own among them.
struct TakenEstimates {
  std::shared_ptr<const ReadPlanes> read;  // of the frame itself; null: nobody kept them
  std::vector<std::shared_ptr<const EstimatedFrame>> of;
  std::vector<int> missing;  // frames that are not there

  /// That of the frame itself.
  const EstimatedFrame& own(int frame) const;
};

/// Names them, for a header; empty where there are none: "frames 3-7; missing 6".
std::string text_of(const TakenEstimates& taken);

/// Where a frame is estimated.
struct EstimateRoom {
  gpu::Recorder& gpu;
  const Room& room;
  // Told which window of an estimate is computed, before each; may throw, which ends it.
  std::function<void(const Window&)> begin = {};
};

/// Frames that are estimated, and kept for as long as a frame takes them that is being computed, or the next one: each
/// is estimated once where frames that lie beside each other are computed after each other. In any other order memory
/// is bounded all the same, and what comes late is estimated again. What a frame takes is the same whatever lane asks,
/// and in whatever order.
class SharedEstimates {
 public:
  /// `frames` are those that are to be computed, in their order; each must be told of by begin() and done(). All are
  /// read as `settled` is; null: each by itself. `shot`: what they see of each other; null: nothing.
  SharedEstimates(const FramePlan& plan, const FrameSource* settled, SharedFrames* shot, std::span<const int> frames);

  /// Gives the estimates around a frame. Fails with ErrorKind::input, naming the file, where one of them cannot be read
  /// or its camera says not where it stands.
  TakenEstimates around(const EstimateRoom& where, int frame, PreparedOthers& took);

  /// From here on what this frame takes is kept.
  void begin(int frame);
  /// No one will ask for what this frame takes.
  void done(int frame);

  /// Frames that are kept now.
  std::size_t kept() const;

 private:
  using Estimated = std::shared_ptr<const EstimatedFrame>;
  struct Entry {
    std::mutex estimating;
    Estimated estimated;
    std::shared_ptr<const ReadPlanes> read;  // for the frame itself, until it is done
  };

  std::shared_ptr<Entry> entry_of(int frame);
  /// The entry's mutex is locked.
  Estimated estimated_in(Entry& entry, const EstimateRoom& where, int frame, PreparedOthers& took);

  const FramePlan& plan_;
  const FrameSource* settled_;
  SharedFrames* shot_;
  mutable std::mutex mutex_;  // of all below
  std::map<int, std::shared_ptr<Entry>> entries_;
  FramesInWork in_work_;
};

/// The upload buffers of a lane that frames' estimates are put into. What is there for one frame is there for the next.
class EstimateSlots {
 public:
  /// Gives the estimates as the frame takes them, for any number of parts of it; none where there are none. No buffer
  /// is larger than `most_bytes`.
  EstimateSet filled(gpu::Recorder& gpu, const FramePlan& plan, const TakenEstimates& taken, int frame,
                     std::uint64_t most_bytes);

 private:
  using Estimated = std::weak_ptr<const EstimatedFrame>;  // tells whether it is the same one, and keeps none
  struct Group {
    const std::byte* buffer = nullptr;  // where it was
    std::size_t stride = 0;             // words of a slot
    std::vector<Estimated> held;        // by slot
  };
  std::vector<Group> groups_;
};

}  // namespace alcove
