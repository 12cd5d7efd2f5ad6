// A frame in host memory through the whole chain.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/base/frame_inputs.h"
#include "core/frame/reading.h"

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

}  // namespace alcove
