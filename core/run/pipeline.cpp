// A frame's steps follow each other on one thread, frames run beside each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/pipeline.h"

#include <condition_variable>
#include <exception>
#include <map>
#include <optional>
#include <thread>

namespace alcove {
namespace {

/// Threads that take the next frame until none is left. Whatever they hand to each other, and the reports in order,
/// passes under one mutex.
class Pipeline {
 public:
  Pipeline(Lanes& lanes, const RunContext& run, std::span<const int> frames,
           const std::function<bool(FrameReport&&)>& next)
      : lanes_(lanes),
        run_(run),
        frames_(frames),
        next_(next),
        most_(std::size_t(lanes.count() > 1 ? 2 * lanes.count() : 1)) {}

  void run() {
    {
      std::vector<std::jthread> others;
      while (int(others.size()) + 1 < lanes_.count()) others.emplace_back([this] { work(); });
      work();
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void work() {
    try {
      while (const auto place = begin()) {
        FrameReport report;
        lanes_.with([&](Lane& lane) { report = run_frame(lane, run_, frames_[*place]); });
        finish(*place, std::move(report));
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      ended_ = true;
      told_one_.notify_all();
    }
  }

  /// The next frame's place in the list.
  std::optional<std::size_t> begin() {
    std::unique_lock lock(mutex_);
    told_one_.wait(lock, [&] { return ended_ || begun_ == frames_.size() || begun_ < told_ + most_; });
    if (ended_ || begun_ == frames_.size() || (run_.stop && run_.stop())) return {};
    return begun_++;
  }

  void finish(std::size_t place, FrameReport&& report) {
    const std::lock_guard lock(mutex_);
    finished_.emplace(place, std::move(report));
    for (; !finished_.empty() && finished_.begin()->first == told_; told_++)
      if (!next_(std::move(finished_.extract(finished_.begin()).mapped()))) ended_ = true;
    told_one_.notify_all();
  }

  Lanes& lanes_;
  const RunContext& run_;
  const std::span<const int> frames_;
  const std::function<bool(FrameReport&&)>& next_;
  // frames begun whose reports are not told: one that is done may have to wait for an earlier one; its lane does not
  const std::size_t most_;
  std::mutex mutex_;  // of all below
  std::condition_variable told_one_;
  std::size_t begun_ = 0, told_ = 0;
  std::map<std::size_t, FrameReport> finished_;  // not told yet
  bool ended_ = false;
  std::exception_ptr error_;
};

}  // namespace

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
  if (made_ > 0 && device().info().type == gpu::DeviceType::cpu)
    devices_.push_back(std::make_unique<gpu::Device>(options_));
  made_++;
  return std::make_unique<Lane>(*devices_.back());
}

void Lanes::with(const std::function<void(Lane&)>& function) {
  auto lane = take();
  function(*lane);
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(lane));
}

void run_pipeline(Lanes& lanes, const RunContext& run, std::span<const int> frames,
                  const std::function<bool(FrameReport&&)>& next) {
  Pipeline(lanes, run, frames, next).run();
}

}  // namespace alcove
