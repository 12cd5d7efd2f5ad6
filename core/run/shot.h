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

/// Values of frames that several frames take: each is made once, by whoever needs it first. Any thread may ask. One
/// that needs what another one makes makes what nobody is at, and only then waits.
template <class T>
class MadeOnce {
 public:
  using Value = std::shared_ptr<const T>;

  /// Those of the frames, in their order. Fails as `make` does: the next one that needs the value tries again.
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

  /// Lets the others go.
  void keep(const std::function<bool(int)>& is_kept) {
    const std::lock_guard lock(mutex_);
    std::erase_if(values_, [&](const auto& value) { return value.second && !is_kept(value.first); });
  }

  /// The number of those that are kept or in the making.
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
  std::map<int, Value> values_;  // null: in the making
};

/// The first surface that one view of a frame sees, in host memory.
struct SeenFrame {
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
struct Others {
  std::vector<OtherView> seen;
  std::vector<int> frames, missing;  // around it: those that it takes, and those that are not there
  std::vector<std::string> views;    // that it takes of its own instant
};

/// Names them, for a header; empty where it takes none: "frames 3-5, 7; missing 6; views right".
std::string text_of(const Others& others);

/// The estimate of one frame, in host memory: planes over all of it.
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
  ReadPlanes read;  // of the frame itself; without planes: nobody kept them
  std::vector<std::shared_ptr<const EstimatedFrame>> of;
  std::vector<int> missing;  // frames that are not there

  /// The estimate of the frame itself.
  const EstimatedFrame& own(int frame) const;
};

/// Names them, for a header; empty where there are none: "frames 3-7; missing 6".
std::string text_of(const TakenEstimates& taken);

/// Passes run and rows read for other frames.
struct PreparationCost {
  std::uint64_t rows_read = 0;
  std::vector<gpu::PassTime> passes = {};
};

/// The recorder and the memory for the estimate of a frame.
struct EstimateRoom {
  gpu::Recorder& gpu;
  const Room& room;
  // Told which window of an estimate is computed, before each; may throw, which ends it.
  std::function<void(const Window&)> begin = {};
};

/// Fails with ErrorKind::input where nobody knows where a frame's camera stands.
void require_place(const FrameSource& source, int frame, const char* option);

/// Whether frames look at others of the shot for more than their estimates; and whether they look at these or at views.
bool takes_frames(const InputSettings& settings);
bool takes_others(const InputSettings& settings);

/// Frames that are prepared and estimated, and kept for as long as a frame takes them that is being computed, or the
/// next one: each is made once where frames that lie beside each other are computed after each other. In any other
/// order memory is bounded all the same, and what comes late is made again. What one frame takes from others is the
/// same whatever lane asks, and in whatever order.
class SharedFrames {
 public:
  /// `frames` are those that are to be computed, in their order; each must be told of by begin() and done(). All are
  /// read as `settled` is; null: each by itself.
  SharedFrames(const FramePlan& plan, const FrameSource* settled, std::span<const int> frames);

  /// Gives what a frame takes from others, in upload buffers of the recorder, which is free before and after. Fails
  /// with ErrorKind::input, naming the file, where one of them cannot be read or its camera says not where it stands.
  Others others_of(gpu::Recorder& gpu, const FrameSource& target, int frame, PreparationCost& cost);

  /// Gives the estimates around a frame. Fails as others_of() does.
  TakenEstimates estimates_of(const EstimateRoom& where, int frame, PreparationCost& cost);

  /// From here on what this frame takes is kept.
  void begin(int frame);
  /// No one will ask for what this frame takes.
  void done(int frame);

  /// Frames whose first surface is kept now, and those whose estimate is.
  std::size_t seen_count() const { return seen_.count(); }
  std::size_t estimated_count() const { return estimated_.count(); }

 private:
  using Seen = MadeOnce<SeenFrame>::Value;
  struct SeenWithMovement {
    Seen seen;
    MadeOnce<Movement>::Value moving;
  };

  std::vector<SeenWithMovement> frames_around(gpu::Recorder& gpu, const FrameSource& target, int frame, Others& others,
                                              PreparationCost& cost);
  std::vector<SeenWithMovement> other_views(gpu::Recorder& gpu, const FrameSource& target, int frame, Others& others,
                                            PreparationCost& cost) const;
  std::vector<Seen> seen(gpu::Recorder& gpu, const std::vector<int>& frames, PreparationCost& cost);
  Movement movement_of(gpu::Recorder& gpu, int frame, PreparationCost& cost);
  /// Marks pixels of a frame that move by its motion vectors, and up to `around` pixels beside each, with 1, all others
  /// with 0. None where the settings name no vectors, and at an end of the shot where they lead out of it. Fails where
  /// no reading of the vectors is right.
  std::optional<std::vector<std::uint8_t>> moving_by_vectors(gpu::Recorder& gpu, int frame, PreparationCost& cost,
                                                             int around);
  /// `option`: by which it is taken.
  SeenFrame prepare(gpu::Recorder& gpu, const InputSettings& settings, int frame, const char* option,
                    PreparationCost& cost) const;
  EstimatedFrame estimate(const EstimateRoom& where, int frame, PreparationCost& cost);

  const FramePlan& plan_;
  const FrameSource* settled_;
  MadeOnce<SeenFrame> seen_;
  MadeOnce<Movement> moving_;
  MadeOnce<EstimatedFrame> estimated_;
  std::mutex mutex_;                // of all below
  std::vector<int> left_;           // frames that are not done, in their order
  std::set<int> begun_;             // of them
  std::map<int, ReadPlanes> read_;  // of frames that are estimated, until they are computed themselves
};

/// The frames that tell what moves in one, of which frames take what stands still.
std::vector<int> judges_of(const FramePlan& plan, int frame);
/// How many of them there are at most, where so many frames to each side are taken.
int most_judges(int count);

/// All frames that change what a frame takes: those around it, and their judges. In order.
std::vector<int> frames_seen_for(const FramePlan& plan, int frame);
/// The distance of the farthest of them from a frame, in frames of the shot.
int farthest_seen(int count);

/// How many frames of the shot are prepared and estimated for those that are computed in their order, each once.
struct SharedCounts {
  std::size_t prepared = 0, estimated = 0;
};
SharedCounts shared_counts(const FramePlan& plan, std::span<const int> frames);

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
