// Host memory -> upload buffers -> chain -> host memory. Rehearses a small frame, which tells the needed kernels, and
// makes them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/compute.h"

#include <algorithm>
#include <span>

#include "core/base/error.h"
#include "core/chain/chain.h"
#include "core/gpu/kernel.h"

namespace alcove {
namespace {

gpu::Buffer* filled(gpu::Recorder& gpu, RawPlane plane, std::span<const float> values) {
  if (values.empty()) return nullptr;
  const char* name = kRawPlanes[std::size_t(plane)].name;
  gpu::Buffer& buffer = gpu.buffer(name, values.size_bytes(), gpu::Use::upload);
  std::ranges::copy(values, buffer.as<float>().begin());
  return &buffer;
}

/// Whether there are as many values as the table allows a plane of so many pixels.
bool fills(RawPlane plane, std::size_t values, std::size_t pixels) {
  const RawPlaneFacts& facts = kRawPlanes[std::size_t(plane)];
  return values % pixels == 0 && values / pixels >= facts.least && values / pixels <= facts.most;
}

/// The kernels that a frame of these settings runs, each once, those with the most code first.
std::vector<gpu::KernelName> kernels_of(const EstimatorSettings& settings, const Wanted& wanted) {
  gpu::Recorder rehearsal;
  record_small_frame(rehearsal, settings, wanted);
  std::vector<gpu::KernelName> names = rehearsal.rehearsed();
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const auto words = [](const gpu::KernelName& name) { return gpu::kernel_code(name.first).size(); };
  std::ranges::stable_sort(names, std::ranges::greater{}, words);
  return names;
}

}  // namespace

FrameInputs upload(gpu::Recorder& gpu, const Reading& reading, const HostPlanes& planes, int frame) {
  const std::size_t pixels = reading.data.pixels();
  const auto depth = planes[RawPlane::depth], behind = planes[RawPlane::behind];
  if (depth.size() != (reading.depth_kind == DepthKind::position ? 3 : 1) * pixels)
    fail(ErrorKind::input, "a frame of {} has {} depth values", to_string(reading.data), depth.size());
  if (behind.size() != reading.behind.size() * pixels || reading.behind.size() > kMostBehindPlanes)
    fail(ErrorKind::input, "a frame of {} with {} planes behind has {} values of theirs", to_string(reading.data),
         reading.behind.size(), behind.size());
  RawPlaneArray<gpu::Buffer*> buffers;
  for (const auto& row : kRawPlanes) {
    const auto values = planes[row.plane];
    if (!values.empty() && !fills(row.plane, values.size(), pixels))
      fail(ErrorKind::input, "a frame of {} has {} values of its {}", to_string(reading.data), values.size(), row.name);
    buffers[row.plane] = filled(gpu, row.plane, values);
  }
  return inputs_of(reading, buffers, frame);
}

FrameInputs upload(gpu::Recorder& gpu, const HostFrame& frame) {
  HostPlanes planes;
  planes[RawPlane::depth] = frame.depth;
  planes[RawPlane::normal] = frame.normal;
  planes[RawPlane::behind] = frame.behind_depth;
  return upload(gpu, frame, planes, frame.frame);
}

HostResult compute_ao(gpu::Recorder& gpu, const HostFrame& frame, const EstimatorSettings& settings) {
  const FrameOutputs outputs = run_chain(gpu, upload(gpu, frame), settings);
  gpu.run();
  const auto ao = outputs.ao->as<float>();
  const auto& counts = outputs.counts->as<FrameCounts>()[0];
  const SiteCounts sites = outputs.sites ? outputs.sites->as<SiteCounts>()[0] : SiteCounts{};
  return {{ao.begin(), ao.end()},  counts.sky,           sites.listed, counts.repaired_depth,
          counts.repaired_normals, counts.turned_normals};
}

void record_small_frame(gpu::Recorder& gpu, EstimatorSettings settings, const Wanted& wanted) {
  constexpr int kSide = 32;  // px
  HostFrame frame;
  frame.data = frame.display = {0, 0, kSide, kSide};
  frame.camera = centred(frame.display, kSide, 1);
  frame.depth.assign(frame.data.pixels(), 1);
  frame.normal.assign(3 * frame.data.pixels(), 1);
  if (!settings.radius) settings.radius = 1;
  FrameInputs inputs = upload(gpu, frame);
  inputs.lights = wanted.lights;
  run_chain(gpu, inputs, settings, wanted);
}

WarmUp::WarmUp(gpu::Device& device, const EstimatorSettings& settings, const Wanted& wanted, int threads) {
  const auto make = [this, &device] {
    try {
      for (std::size_t place = next_++; place < names_.size(); place = next_++)
        device.kernel(names_[place].first, names_[place].second);
    } catch (...) {
      // Whoever needs the kernel fails as this thread did.
    }
  };
  try {
    names_ = kernels_of(settings, wanted);
    for (int i = 0; i < threads; i++) threads_.emplace_back(make);
  } catch (...) {
    // So does whoever needs what could not be rehearsed; and where there are no threads, frames make their kernels.
  }
}

}  // namespace alcove
