// oneTBB: a frame's steps follow each other on one thread, frames run beside each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline.h"

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <atomic>

namespace alcove {

Lanes::Lanes(const gpu::DeviceOptions& options, int count, int gpu_count) : options_(options) {
  devices_.push_back(std::make_unique<gpu::Device>(options));
  count_ = device().info().type == gpu::DeviceType::cpu ? count : gpu_count;
}

int Lanes::validation_messages() const {
  int messages = 0;
  for (const auto& device : devices_) messages += device->validation_messages();
  return messages;
}

std::unique_ptr<Lane> Lanes::take() {
  const std::lock_guard lock(mutex_);
  if (!free_.empty()) {
    auto lane = std::move(free_.back());
    free_.pop_back();
    return lane;
  }
  if (made_ > 0 && device().info().type == gpu::DeviceType::cpu) devices_.push_back(std::make_unique<gpu::Device>(options_));
  made_++;
  return std::make_unique<Lane>(*devices_.back());
}

void Lanes::with(const std::function<void(Lane&)>& function) {
  auto lane = take();
  function(*lane);
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(lane));
}

void run_pipeline(Lanes& lanes, const RunContext& run, std::span<const int> frames, const std::function<bool(FrameReport&&)>& next) {
  std::atomic<bool> ended = false;
  std::size_t begun = 0;
  const auto begin = [&](tbb::flow_control& control) -> int {
    if (begun == frames.size() || ended || (run.stop && run.stop())) {
      control.stop();
      return 0;
    }
    return frames[begun++];
  };
  const auto work = [&](int frame) {
    auto report = std::make_unique<FrameReport>();
    lanes.with([&](Lane& lane) { *report = run_frame(lane, run, frame); });
    return report.release();
  };
  const auto end = [&](FrameReport* raw) {
    const std::unique_ptr<FrameReport> report(raw);
    if (!next(std::move(*report))) ended = true;
  };
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, std::size_t(lanes.count()));
  tbb::task_arena arena(lanes.count());
  // A frame that is done may have to wait for the report of an earlier one; its lane does not.
  const auto tokens = std::size_t(lanes.count() > 1 ? 2 * lanes.count() : 1);
  arena.execute([&] {
    tbb::parallel_pipeline(tokens, tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order, begin) &
                                       tbb::make_filter<int, FrameReport*>(tbb::filter_mode::parallel, work) &
                                       tbb::make_filter<FrameReport*, void>(tbb::filter_mode::serial_in_order, end));
  });
}

}  // namespace alcove
