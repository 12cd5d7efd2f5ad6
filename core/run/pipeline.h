// Frames in flight: while one is computed others are read and written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/run/frame_run.h"

namespace alcove {

/// Where frames are computed: as many recorders, each with buffers that are kept, as there are frames in flight. A CPU
/// device is made anew for each of them, so that every frame has a core of its own from its first byte to its last, and
/// none waits for another; a GPU is shared.
class Lanes {
 public:
  /// As many as `count`, or on a GPU `gpu_count`.
  Lanes(const gpu::DeviceOptions& options, int count, int gpu_count);

  const gpu::Device& device() const { return *devices_.front(); }
  int count() const { return count_; }
  int validation_messages() const;

  /// Runs the function with a lane that nobody else uses. Not more than count() at once.
  void with(const std::function<void(Lane&)>& function);

 private:
  std::unique_ptr<Lane> take();

  gpu::DeviceOptions options_;
  int count_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<gpu::Device>> devices_;
  std::vector<std::unique_ptr<Lane>> free_;
  std::size_t made_ = 0;  // lanes
};

/// Runs the frames on the lanes, in any order, and hands on their reports in theirs. After `next` has answered false no
/// frame is begun.
void run_pipeline(Lanes& lanes, const RunContext& run, std::span<const int> frames,
                  const std::function<bool(FrameReport&&)>& next);

}  // namespace alcove
