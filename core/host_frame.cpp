// Host memory -> upload buffers -> chain -> host memory.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/host_frame.h"

#include <algorithm>

#include "core/chain.h"
#include "core/error.h"
#include "kernels/prepare.h"

namespace alcove {
namespace {

gpu::Buffer* upload(gpu::Recorder& gpu, const char* name, std::span<const float> values) {
  if (values.empty()) return nullptr;
  gpu::Buffer& buffer = gpu.buffer(name, values.size_bytes(), gpu::Use::upload);
  std::ranges::copy(values, buffer.as<float>().begin());
  return &buffer;
}

}  // namespace

HostResult compute_ao(gpu::Recorder& gpu, const HostFrame& frame, const EstimatorSettings& settings) {
  if (frame.depth.size() != frame.data.pixels() || (!frame.normal.empty() && frame.normal.size() != 3 * frame.data.pixels()))
    fail(ErrorKind::input, "a frame of {} has {} depth and {} normal values", to_string(frame.data), frame.depth.size(), frame.normal.size());
  const Matrix3 identity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  FrameInputs inputs;
  inputs.view = view_of(frame.camera, frame.data, frame.display);
  inputs.noise_origin = {frame.data.x - frame.display.x, frame.data.y - frame.display.y};
  inputs.frame = frame.frame;
  inputs.depth_kind = frame.depth_kind;
  inputs.depth_scale = frame.depth_scale;
  inputs.sky = frame.sky;
  inputs.view_from_normal = frame.normal_space == NormalSpace::world ? frame.camera.view_from_world.value() : identity;
  inputs.depth = upload(gpu, "raw depth", frame.depth);
  inputs.normal = upload(gpu, "raw normal", frame.normal);

  const FrameOutputs outputs = run_chain(gpu, inputs, settings);
  gpu.run();
  const auto ao = outputs.ao->as<float>();
  const auto& counts = outputs.counts->as<PrepareCounts>()[0];
  return {{ao.begin(), ao.end()}, counts.sky, counts.repaired_depth, counts.repaired_normals};
}

}  // namespace alcove
