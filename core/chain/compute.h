// A frame in host memory through the whole chain: for its result, or a small one for the pipelines of a run, which are
// made while its first frame is read: half of a small frame's time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/base/frame_inputs.h"
#include "core/frame/reading.h"
#include "core/gpu/device.h"
#include "core/gpu/recorder.h"

namespace alcove {

/// Planes of a frame in host memory, the components of each one behind the other; empty: the frame has no such plane.
using HostPlanes = RawPlaneArray<std::span<const float>>;

/// The planes in upload buffers, as run_chain() takes them. Fails with ErrorKind::input when they do not fill the data
/// window.
FrameInputs upload(gpu::Recorder& gpu, const Reading& reading, const HostPlanes& planes, int frame);
FrameInputs upload(gpu::Recorder& gpu, const HostFrame& frame);

/// The chain's result for a frame in host memory.
struct HostResult {
  std::vector<float> ao;  // one value per pixel: visibility in [0, 1]
  std::uint32_t sky_pixels = 0;
  std::uint32_t estimates = 0;  // pixels with one of their own; 0 if each has one
  std::uint32_t repaired_depth = 0;
  std::uint32_t repaired_normals = 0;
  std::uint32_t turned_normals = 0;
};

/// Runs prepare, the estimator and the shaping. settings.radius must be set. Fails with ErrorKind::device.
HostResult compute_ao(gpu::Recorder& gpu, const HostFrame& frame, const EstimatorSettings& settings);

struct Wanted;

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
