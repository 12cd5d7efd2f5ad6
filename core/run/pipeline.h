// Frames in flight: while one is computed, others are read and written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/run/frame_run.h"

namespace alcove {

/// The places where frames are computed: one lane for each frame in flight, whose buffers are kept from frame to frame.
/// Each lane on a CPU has a device of its own, so that every frame has a core of its own from its first byte to its
/// last, and no frame waits for another. A GPU is shared by all lanes.
class Lanes {
 public:
  Lanes(const gpu::DeviceOptions& options, int count);

  gpu::Device& device() { return *devices_.front(); }
  int count() const;
  int validation_messages() const;

  /// Changes the number of lanes. The buffers of those that nobody uses are given back.
  void set_count(int count);

  /// Runs the function with a lane that nobody else uses. At most count() threads may do so at once. The function says
  /// whether the lane keeps its buffers.
  void with(const std::function<bool(Lane&)>& function);

 private:
  struct Place {
    gpu::Device* device;
    std::unique_ptr<Lane> lane;  // null: without buffers
  };
  Place take();

  gpu::DeviceOptions options_;
  int count_;
  mutable std::mutex mutex_;  // of all that may change
  std::vector<std::unique_ptr<gpu::Device>> devices_;
  std::vector<Place> free_;
  bool is_first_taken_ = false;
};

/// Who follows the frames of a pipeline.
struct PipelineWatch {
  /// Whether a report is the last: no frame is begun after it. Called by any thread.
  std::function<bool(const FrameReport&)> ends;
  /// Takes the reports in the order of the frames, on the thread that runs the pipeline. While it waits, for a terminal
  /// that stands still, say, frames go on.
  std::function<void(FrameReport&&)> tell;
  /// Told about once a second how far the frames in flight are, on the same thread; may be empty.
  std::function<void(std::span<const FrameProgress>)> working = {};
};

/// Runs the frames on the lanes, in any order. Where the device has no memory for a frame, the number of lanes is
/// halved, down to one, and then the window that is computed at once; the frame is computed again, and says so in a
/// note. Later frames begin with what is left then.
void run_pipeline(Lanes& lanes, const RunContext& run, Room room, std::span<const int> frames,
                  const PipelineWatch& watch);

}  // namespace alcove
