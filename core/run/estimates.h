// The mean of the estimates around a frame, their form in upload buffers, and the store of frames that a shot shares.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/chain/base/frame_inputs.h"
#include "core/gpu/recorder.h"
#include "core/run/frame_files.h"
#include "core/run/neighbours.h"
#include "core/run/plan.h"
#include "core/run/run_report.h"

namespace alcove {

/// The estimate of one frame, in host memory: planes over all of it.
struct EstimatedFrame {
  int frame = 0;
  Camera camera;
  View view{};
  vec3 depth_precision{};             // of planar depth: see DepthPrecision
  std::vector<float> depth;           // see NeighbourFrame
  bool has_moving = false;            // some depth is below 0
  std::vector<std::uint32_t> normal;  // the same
  std::vector<float> values;          // planes: see EstimateSet
  FrameReport report;                 // times and counts of its estimate
  Neighbours others;                  // the names of the frames and views that show its hidden surfaces
};

/// Whether a cut lies between two frames: two sets may stand at one place of the world. Each frame then sees past most
/// surfaces of the other one. Frames without a common view have no cut, since neither harms the other.
bool is_cut_between(const EstimatedFrame& a, const EstimatedFrame& b);

/// The estimates whose mean is a frame, with the frame's own estimate.
struct NeighbourEstimates {
  ReadPlanes read;  // of the frame itself; empty: not kept
  std::vector<std::shared_ptr<const EstimatedFrame>> of;
  std::vector<int> missing;  // frames without a file

  /// The estimate of the frame itself.
  const EstimatedFrame& own(int frame) const;
};

/// The text for a header; empty without estimates: "frames 3-7; missing 6".
std::string text_of(const NeighbourEstimates& taken);

/// The upload buffers of a lane for estimates. Slots keep their contents between frames.
class EstimateSlots {
 public:
  /// Gives the estimates for a frame, or for any number of its parts. No buffer is larger than `most_bytes`.
  EstimateSet filled(gpu::Recorder& gpu, const FramePlan& plan, const NeighbourEstimates& taken, int frame,
                     std::uint64_t most_bytes);

 private:
  using Estimated = std::weak_ptr<const EstimatedFrame>;  // identifies an estimate without keeping it
  struct Group {
    const std::byte* buffer = nullptr;  // the address at the last call
    std::size_t stride = 0;             // words of a slot
    std::vector<Estimated> held;        // by slot
  };
  std::vector<Group> groups_;
};

/// Prepared and estimated frames. A frame stays while one of its users is being computed or comes next. If neighbours
/// are computed one after the other, each frame is made once. In any other order, late frames are made again, and
/// memory is bounded all the same. The results depend neither on the asking lane nor on the order.
class SharedFrames {
 public:
  /// `frames`: the frames to compute, in their order. The caller must call begin() and done() for each. `settled` has
  /// the reading of all frames; null: each frame has its own.
  SharedFrames(const FramePlan& plan, const FrameSource* settled, std::span<const int> frames)
      : plan_(plan), views_(plan, settled), left_(frames.begin(), frames.end()) {}

  NeighbourViews& views() { return views_; }

  /// Gives the estimates around a frame, but none behind a cut. `estimate` makes the estimate of one frame. Fails as
  /// `estimate` does.
  NeighbourEstimates estimates_of(int frame, const std::function<EstimatedFrame(int)>& estimate);
  /// Keeps the planes that were read for a frame's estimate until estimates_of() gives them.
  void keep_planes(int frame, ReadPlanes&& read);

  /// Pins the frames that this one needs.
  void begin(int frame);
  /// Releases them.
  void done(int frame);

  /// The number of estimates that are kept now.
  std::size_t estimated_count() const { return estimated_.count(); }

 private:
  const FramePlan& plan_;
  NeighbourViews views_;
  SharedCache<EstimatedFrame> estimated_;
  std::mutex mutex_;                // of all below
  std::vector<int> left_;           // frames that are not done, in their order
  std::set<int> begun_;             // of them
  std::map<int, ReadPlanes> read_;  // of frames that are estimated, until they are computed themselves
};

}  // namespace alcove
