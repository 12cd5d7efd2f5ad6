// A frame in host memory through the whole chain: for tests, benchmarks and programs that link the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/base/settings.h"
#include "core/chain/passes.h"
#include "core/frame/camera.h"
#include "core/gpu/recorder.h"

namespace alcove {

/// Depth and normals of one frame, rows from the top, over the data window.
struct HostFrame {
  Window data, display;
  Camera camera;  // for the display window
  // of depth_kind, positions: planes x, y, z; sky: at or beyond `sky`, or 0, infinite, NaN
  std::vector<float> depth;
  // planes x, y, z (or two, see kernels/prepare.h) in normal_space; empty: reconstructed from depth
  std::vector<float> normal;
  DepthKind depth_kind = DepthKind::planar;      // not automatic
  NormalSpace normal_space = NormalSpace::view;  // not automatic; world needs camera.view_from_world
  double depth_scale = 1, sky = 1e9;
  bool depth_is_half = false;  // the values were rounded to half floats
  double depth_step = 0;       // see step_of()
  DepthRange depth_range;
  PositionSpace position_space = PositionSpace::view;             // not automatic; world needs camera.view_from_world
  NormalEncoding normal_encoding = NormalEncoding::signed_float;  // not automatic
  bool normal_unorm = false;                                      // the values are 0.5 + 0.5 n
  NormalFlips flip_normal;
  int frame = 0;
};

/// Finds and reads the depth and normals that the settings name. Fails as find_frame() and read_planes() do.
HostFrame read_host_frame(const InputSettings& settings, int frame);

/// The frame in upload buffers, as run_chain() takes it. Fails with ErrorKind::input when its planes do not fill its
/// data window.
FrameInputs upload(gpu::Recorder& gpu, const HostFrame& frame);

/// What the chain makes of it.
struct HostResult {
  std::vector<float> ao;  // a value a pixel: visibility in [0, 1]
  std::uint32_t sky_pixels = 0, repaired_depth = 0, repaired_normals = 0;
};

/// Runs prepare, the estimator and the shaping. settings.radius must be set. Fails with ErrorKind::device.
HostResult compute_ao(gpu::Recorder& gpu, const HostFrame& frame, const EstimatorSettings& settings);

}  // namespace alcove
