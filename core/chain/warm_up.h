// Makes the pipelines of a run while its first frame is read: half of a small frame's time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "core/chain/results/outputs.h"
#include "core/gpu/device.h"
#include "core/gpu/recorder.h"

namespace alcove {

/// Records the chain for a frame of a few pixels, with most kernels that any frame of these settings uses.
void record_small_frame(gpu::Recorder& gpu, EstimatorSettings settings, const Wanted& wanted);

/// Threads that make pipelines, each once, the largest first, while others read the first frame. A frame makes further
/// pipelines itself. The destructor waits for the threads. Never fails.
class WarmUp {
 public:
  /// The device must outlive it.
  WarmUp(gpu::Device& device, const EstimatorSettings& settings, const Wanted& wanted, int threads);
  ~WarmUp() { next_ = names_.size(); }  // skips the rest
  WarmUp(const WarmUp&) = delete;
  WarmUp& operator=(const WarmUp&) = delete;

  /// The kernels that are made.
  const std::vector<gpu::KernelName>& names() const { return names_; }

 private:
  std::vector<gpu::KernelName> names_;
  std::atomic<std::size_t> next_ = 0;
  std::vector<std::jthread> threads_;  // destroyed first
};

}  // namespace alcove
