// Surfaces of a frame that other frames and views show. Every frame is prepared once for all its users.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/chain/base/frame_inputs.h"
#include "core/frame/find/frame_source.h"
#include "core/gpu/recorder.h"
#include "core/run/plan.h"

namespace alcove {

/// Values of frames for several users. The first thread that needs a value makes it, once. Any thread may ask. If
/// another thread is making the value, the asking thread makes another missing value first, and then waits.
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

/// The moving pixels of a frame, which other frames must not use.
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

/// Passes run and rows read for other frames.
struct PreparationCost {
  std::uint64_t rows_read = 0;
  std::vector<gpu::PassTime> passes = {};
};

/// An upload buffer with these values.
template <class T>
gpu::Buffer& uploaded(gpu::Recorder& gpu, const std::string& name, const std::vector<T>& values) {
  gpu::Buffer& buffer = gpu.buffer(name, values.size() * sizeof(T), gpu::Use::upload);
  std::ranges::copy(values, buffer.as<T>().begin());
  return buffer;
}

/// Fails with ErrorKind::input if the position of a frame's camera is unknown.
void require_place(const FrameSource& source, int frame, const char* option);

/// Prepared frames of a shot and the movement in them, for all threads of a run. The results depend neither on the
/// asking thread nor on the order.
class NeighbourViews {
 public:
  /// `settled` has the reading of all frames; null: each frame has its own.
  NeighbourViews(const FramePlan& plan, const FrameSource* settled) : plan_(plan), settled_(settled) {}

  /// Gives the surfaces of a frame that other frames and views show, in upload buffers of the recorder. The recorder is
  /// idle before and after. Fails with ErrorKind::input, naming the file, if a file cannot be read, or if the position
  /// of its camera is unknown.
  Neighbours of(gpu::Recorder& gpu, const FrameSource& target, int frame, PreparationCost& cost);

  /// Marks pixels that move by their motion vectors, and up to `around` pixels beside each, with 1, all others with 0.
  /// Gives none if the settings name no vectors, or if the vectors lead out of the shot at its end. Fails if no
  /// interpretation of the vectors matches the cameras.
  std::optional<std::vector<std::uint8_t>> moving_by_vectors(gpu::Recorder& gpu, int frame, PreparationCost& cost,
                                                             int around);

  /// Drops all frames that are not kept.
  void keep(const std::function<bool(int)>& is_kept);

  /// The number of frames that are kept now.
  std::size_t count() const { return seen_.count(); }

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
  /// `option`: the one that asks for other frames, for messages.
  NeighbourView prepare(gpu::Recorder& gpu, const InputSettings& settings, int frame, const char* option,
                        PreparationCost& cost) const;

  const FramePlan& plan_;
  const FrameSource* settled_;
  SharedCache<NeighbourView> seen_;
  SharedCache<Movement> moving_;
};

}  // namespace alcove
