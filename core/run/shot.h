// The frames of a shot that use each other: each is prepared and estimated once, and kept as long as it is needed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <vector>

#include "core/base/shared_cache.h"
#include "core/run/estimates.h"
#include "core/run/frame_files.h"
#include "core/run/neighbours.h"
#include "core/run/plan.h"

namespace alcove {

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
