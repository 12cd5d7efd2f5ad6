// What the frames of a shot see and estimate of each other: every frame is prepared and estimated once for all that
// take it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/chain/base/frame_inputs.h"
#include "core/gpu/recorder.h"
#include "core/run/frame_files.h"
#include "core/run/plan.h"
#include "core/run/run_report.h"
#include "core/run/tiles.h"

namespace alcove {

/// Values of frames that several frames take: each is made once, by the first thread that needs it. Any thread may ask.
/// A thread whose value is being made elsewhere makes another missing value first, then waits.
template <class T>
class SharedCache {
 public:
  using Value = std::shared_ptr<const T>;

  /// The values of the frames, in their order. Fails as `make` does; the next thread that needs the value tries again.
  std::vector<Value> of(std::span<const int> frames, const std::function<T(int)>& make) {
    std::vector<Value> values(frames.size());
    std::unique_lock lock(mutex_);
    while (true) {
      bool are_all = true;
      std::optional<int> free;
      for (std::size_t i = 0; i < frames.size(); i++) {
        const auto known = values_.find(frames[i]);
        if (!values[i] && known != values_.end()) values[i] = known->second;
        if (!values[i] && known == values_.end() && !free) free = frames[i];
        are_all = are_all && values[i];
      }
      if (are_all) return values;
      if (free)
        make_one(*free, make, lock);
      else
        changed_.wait(lock);
    }
  }

  /// Drops all values whose frame is not kept.
  void keep(const std::function<bool(int)>& is_kept) {
    const std::lock_guard lock(mutex_);
    std::erase_if(values_, [&](const auto& value) { return value.second && !is_kept(value.first); });
  }

  /// The number of values that exist or are being made.
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return values_.size();
  }

 private:
  void make_one(int frame, const std::function<T(int)>& make, std::unique_lock<std::mutex>& lock) {
    values_[frame] = nullptr;
    lock.unlock();
    try {
      auto made = std::make_shared<const T>(make(frame));
      lock.lock();
      values_[frame] = std::move(made);
    } catch (...) {
      lock.lock();
      values_.erase(frame);
      changed_.notify_all();
      throw;
    }
    changed_.notify_all();
  }

  mutable std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::map<int, Value> values_;  // null: being made
};

/// The first surface that one view of a frame sees, in host memory.
struct NeighbourView {
  Camera camera;
  Window data, display;
  View view{};
  vec3 depth_precision{};
  std::vector<float> depth;           // planar; kSkyDepth for sky
  std::vector<std::uint32_t> normal;  // packed, in its own view space
  std::uint64_t hash = 0;             // of both planes
};

/// Pixels of a frame that other frames must not use, since they move.
struct Movement {
  std::vector<std::uint32_t> flags;  // of each pixel, see OtherView::moving
  std::uint64_t hash = 0;            // of them
};

/// Surfaces that a frame takes from others.
struct Neighbours {
  std::vector<OtherView> seen;
  std::vector<int> frames, missing;  // neighbouring frames that it uses, and those without a file
  std::vector<std::string> views;    // other views of its own instant
};

/// The text for a header; empty without others: "frames 3-5, 7; missing 6; views right".
std::string text_of(const Neighbours& others);

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

/// The estimates whose mean a frame is, its own among them.
struct NeighbourEstimates {
  ReadPlanes read;  // of the frame itself; empty: not kept
  std::vector<std::shared_ptr<const EstimatedFrame>> of;
  std::vector<int> missing;  // frames without a file

  /// The estimate of the frame itself.
  const EstimatedFrame& own(int frame) const;
};

/// The text for a header; empty without estimates: "frames 3-7; missing 6".
std::string text_of(const NeighbourEstimates& taken);

/// Passes run and rows read for other frames.
struct PreparationCost {
  std::uint64_t rows_read = 0;
  std::vector<gpu::PassTime> passes = {};
};

/// The recorder and the memory for the estimate of a frame.
struct EstimateContext {
  gpu::Recorder& gpu;
  const MemoryBudget& budget;
  // Called with each window of an estimate before it is computed; an exception ends the estimate.
  std::function<void(const Window&)> begin = {};
};

/// Fails with ErrorKind::input if the position of a frame's camera is unknown.
void require_place(const FrameSource& source, int frame, const char* option);

/// takes_frames: whether frames use surfaces or movement of other frames; takes_others: of other frames or views.
bool takes_frames(const InputSettings& settings);
bool takes_others(const InputSettings& settings);

/// Prepared and estimated frames. A frame is kept while one that uses it is being computed or comes next. If neighbours
/// are computed one after the other, each frame is made once. In any other order memory is bounded all the same, and
/// late frames are made again. The results depend neither on the lane that asks nor on the order.
class SharedFrames {
 public:
  /// `frames`: the frames to compute, in their order; begin() and done() must be called for each. All are read as
  /// `settled` is; null: each by itself.
  SharedFrames(const FramePlan& plan, const FrameSource* settled, std::span<const int> frames);

  /// Gives the surfaces that others show of a frame, in upload buffers of the recorder, which is idle before and after.
  /// Fails with ErrorKind::input, naming the file, if one cannot be read or has no position of its camera.
  Neighbours neighbours_of(gpu::Recorder& gpu, const FrameSource& target, int frame, PreparationCost& cost);

  /// Gives the estimates around a frame. Fails as neighbours_of() does.
  NeighbourEstimates estimates_of(const EstimateContext& where, int frame, PreparationCost& cost);

  /// Pins the frames that this one needs.
  void begin(int frame);
  /// Releases them.
  void done(int frame);

  /// The numbers of prepared frames, and of estimates, that are kept now.
  std::size_t seen_count() const { return seen_.count(); }
  std::size_t estimated_count() const { return estimated_.count(); }

 private:
  using SharedView = SharedCache<NeighbourView>::Value;
  struct ViewWithMovement {
    SharedView seen;
    SharedCache<Movement>::Value moving;
  };

  std::vector<ViewWithMovement> frames_around(gpu::Recorder& gpu, const FrameSource& target, int frame,
                                              Neighbours& others, PreparationCost& cost);
  std::vector<ViewWithMovement> other_views(gpu::Recorder& gpu, const FrameSource& target, int frame,
                                            Neighbours& others, PreparationCost& cost) const;
  std::vector<SharedView> seen(gpu::Recorder& gpu, const std::vector<int>& frames, PreparationCost& cost);
  Movement movement_of(gpu::Recorder& gpu, int frame, PreparationCost& cost);
  /// Marks pixels that move by their motion vectors, and up to `around` pixels beside each, with 1, all others with 0.
  /// None if the settings name no vectors, and at the end of a shot that they lead out of. Fails if no interpretation
  /// of the vectors matches the cameras.
  std::optional<std::vector<std::uint8_t>> moving_by_vectors(gpu::Recorder& gpu, int frame, PreparationCost& cost,
                                                             int around);
  /// `option`: the one that asks for other frames, for messages.
  NeighbourView prepare(gpu::Recorder& gpu, const InputSettings& settings, int frame, const char* option,
                        PreparationCost& cost) const;
  EstimatedFrame estimate(const EstimateContext& where, int frame, PreparationCost& cost);

  const FramePlan& plan_;
  const FrameSource* settled_;
  SharedCache<NeighbourView> seen_;
  SharedCache<Movement> moving_;
  SharedCache<EstimatedFrame> estimated_;
  std::mutex mutex_;                // of all below
  std::vector<int> left_;           // frames that are not done, in their order
  std::set<int> begun_;             // of them
  std::map<int, ReadPlanes> read_;  // of frames that are estimated, until they are computed themselves
};

/// The frames that show movement in `frame`.
std::vector<int> witnesses_of(const FramePlan& plan, int frame);
/// Their largest number with `count` frames to each side.
int most_witnesses(int count);

/// All frames that influence a frame: those around it, and the frames that show movement in these. In order.
std::vector<int> frames_seen_for(const FramePlan& plan, int frame);
/// The distance of the farthest of them, in frames of the shot.
int farthest_seen(int count);

/// The numbers of frames of the shot that are prepared and estimated, each once, for frames computed in this order.
struct SharedCounts {
  std::size_t prepared = 0, estimated = 0;
};
SharedCounts shared_counts(const FramePlan& plan, std::span<const int> frames);

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

}  // namespace alcove
