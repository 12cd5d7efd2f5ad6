// Host memory -> upload buffers -> chain -> host memory.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/host_frame.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/chain/chain.h"
#include "core/frame/gbuffer.h"
#include "core/frame/settle.h"
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

HostFrame read_host_frame(const InputSettings& settings, int number) {
  FrameSource source = find_frame(settings, false, number);
  require_host_room(source.files[source.depth[0].file].path(), source.data);
  HostFrame frame;
  frame.data = source.data;
  frame.display = source.display;
  frame.camera = source.camera;
  frame.depth_scale = settings.depth_scale;
  frame.sky = settings.sky;
  frame.frame = number;
  frame.depth.resize(source.depth.size() * source.data.pixels());
  frame.normal.resize(source.normal.size() * source.data.pixels());
  read_planes(source, {{&source.depth, frame.depth.data()}, {&source.normal, frame.normal.data()}});
  settle(source, settings, frame.depth, frame.normal);
  frame.depth_is_half = has_half_depth(source);
  frame.depth_step = source.depth_step;
  frame.depth_kind = source.depth_kind;
  frame.depth_range = source.depth_range;
  frame.position_space = source.position_space;
  frame.normal_space = source.normal_space;
  frame.normal_encoding = source.normal_encoding;
  frame.normal_unorm = source.normal_unorm;
  frame.flip_normal = source.flip_normal;
  return frame;
}

FrameInputs upload(gpu::Recorder& gpu, const HostFrame& frame) {
  const std::size_t pixels = frame.data.pixels();
  if (frame.depth.size() != (frame.depth_kind == DepthKind::position ? 3 * pixels : pixels) ||
      (!frame.normal.empty() && frame.normal.size() != 3 * pixels && frame.normal.size() != 2 * pixels))
    fail(ErrorKind::input, "a frame of {} has {} depth and {} normal values", to_string(frame.data), frame.depth.size(),
         frame.normal.size());
  FrameInputs inputs;
  inputs.view = view_of(frame.camera, frame.data, frame.display);
  inputs.noise_origin = {frame.data.x - frame.display.x, frame.data.y - frame.display.y};
  inputs.frame = frame.frame;
  inputs.depth_map =
      depth_map(frame.depth_kind, frame.depth_range, frame.position_space, frame.camera, frame.depth_scale, frame.sky);
  inputs.depth_precision =
      depth_precision(inputs.depth_map, frame.depth_is_half ? kHalfPrecision : kFloatPrecision, frame.depth_step);
  inputs.normal_encoding = frame.normal_encoding;
  inputs.normal_unorm = frame.normal_unorm;
  if (!frame.normal.empty())
    inputs.view_from_normal = view_from_normal(frame.camera, frame.normal_space, frame.flip_normal);
  inputs.is_sky = is_all_sky(inputs.depth_map, frame.depth);
  inputs.depth = upload(gpu, "raw depth", frame.depth);
  inputs.normal = upload(gpu, "raw normal", frame.normal);
  return inputs;
}

HostResult compute_ao(gpu::Recorder& gpu, const HostFrame& frame, const EstimatorSettings& settings) {
  const FrameOutputs outputs = run_chain(gpu, upload(gpu, frame), settings);
  gpu.run();
  const auto ao = outputs.ao->as<float>();
  const auto& counts = outputs.counts->as<FrameCounts>()[0];
  return {{ao.begin(), ao.end()}, counts.sky, counts.repaired_depth, counts.repaired_normals};
}

}  // namespace alcove
