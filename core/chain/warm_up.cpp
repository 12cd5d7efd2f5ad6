// Rehearses a frame of a few pixels, which tells the kernels that are needed, and makes them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/warm_up.h"

#include <algorithm>

#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/gpu/kernel.h"

namespace alcove {

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

namespace {

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
