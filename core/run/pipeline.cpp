// A frame's steps follow each other on one thread, and frames run beside each other.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <optional>
#include <thread>
#include <vector>

#include "core/run/frame_run.h"

namespace alcove {
namespace {

constexpr std::chrono::seconds kTold{1};  // between two times that it is told how far frames are

/// Threads that take the next frame until none is left, and the thread that tells of the frames in their order. What
/// they hand to each other passes under one mutex, and nobody prints or computes while holding it.
class Pipeline {
 public:
  Pipeline(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, std::span<const int> frames,
           const TakeReport& take_report, const TakeProgress& take_progress)
      : lanes_(lanes),
        run_(run),
        frames_(frames),
        take_report_(take_report),
        take_progress_(take_progress),
        budget_(budget),
        most_in_flight_(lanes.count()) {}

  /// Starts a thread for each lane. Where the system gives no more threads the run ends with its error, once those that
  /// have begun are done.
  void start(std::vector<std::jthread>& workers) {
    const int wanted = lanes_.count();
    working_ = wanted;
    try {
      while (int(workers.size()) < wanted) workers.emplace_back([this] { work(); });
    } catch (...) {
      end_with(std::current_exception());
      const Lock lock(mutex_);
      working_ -= wanted - int(workers.size());
    }
  }

  /// Tells of the frames in their order, until all have ended.
  void tell() {
    try {
      while (auto report = next_report()) take_report_(std::move(*report));
    } catch (...) {
      end_with(std::current_exception());
    }
  }

  void rethrow_error() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  using Lock = std::unique_lock<std::mutex>;

  // Each worker does this.

  void work() {
    try {
      while (auto attempt = begin()) compute(*attempt);
    } catch (...) {
      end_with(std::current_exception());
    }
    const std::lock_guard lock(mutex_);
    working_--;
    changed_.notify_all();
  }

  /// A try at one frame, with what was learned from earlier ones.
  struct Attempt {
    std::size_t place;  // of the frame, in the list
    MemoryBudget budget;
    int most_in_flight;      // frames, when it began
    bool was_alone = false;  // no other frame was in flight, and no buffers were left of earlier ones
    Notes notes = {};
    std::optional<Error> out_of_memory = {};
  };

  /// Begins the next frame; nothing where no frame is to be begun.
  std::optional<Attempt> begin() {
    Lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || begun_ == frames_.size() || in_flight_ + waiting_ < most_in_flight_; });
    if (ended_ || begun_ == frames_.size() || (run_.stop && run_.stop())) return {};
    in_flight_++;
    const int frame = frames_[begun_];
    if (run_.shot) run_.shot->begin(frame);
    working_on_[frame] = {Stopwatch(), main_input(run_.plan.at(frame).input)};
    return Attempt{begun_++, budget_, most_in_flight_};
  }

  /// Computes a frame, again and again where the device has no memory for it and less at once may find some.
  void compute(Attempt& attempt) {
    const int frame = frames_[attempt.place];
    const auto watch = [&](int part, int parts, double done) { note_part(frame, part, parts, done); };
    FrameReport report;
    do {
      report = run_frame(lanes_, run_, attempt.budget, frame, watch);
      if (report.out_of_memory) attempt.out_of_memory = report.error;
    } while (report.out_of_memory && make_room(report.pixels_at_once, attempt));

    if (report.state == FrameState::done)
      report.notes.insert(report.notes.end(), attempt.notes.begin(), attempt.notes.end());
    // The first failure is why the frame was cut: report it, too.
    const bool is_too_large =
        report.error && report.error->kind() == ErrorKind::device && !report.device_lost && !report.out_of_memory;
    if (is_too_large && attempt.out_of_memory)
      report.error = Error(ErrorKind::device, fmt::format("{}; in smaller parts: {}", attempt.out_of_memory->what(),
                                                          report.error->what()));
    finish(attempt.place, attempt.budget, std::move(report));
  }

  void note_part(int frame, int part, int parts, double done) {
    const Lock lock(mutex_);
    Work& work = working_on_.at(frame);
    work.part = part;
    work.parts = parts;
    work.done = (part - 1 + done) / parts;
  }

  /// After a frame has found no memory: fewer frames at once, then this one alone, then less of it at once. Waits until
  /// the frame may be computed again. False where nothing is left that could be less.
  bool make_room(std::uint64_t pixels, Attempt& attempt) {
    Lock lock(mutex_);
    // Of several frames that fail side by side only the first one halves their number.
    const bool is_fewer_already = most_in_flight_ < attempt.most_in_flight;
    if (!is_fewer_already && most_in_flight_ > 1) {
      attempt.notes.push_back(
          {NoteCode::device_memory,
           fmt::format("the device had no memory for {} frames at once; from here on it computes {}", most_in_flight_,
                       most_in_flight_ / 2)});
      most_in_flight_ /= 2;
      lanes_.set_count(most_in_flight_);
    } else if (!is_fewer_already && !attempt.was_alone) {
      attempt.notes.push_back(
          {NoteCode::device_memory, "the device had no memory for this frame at first; it was computed again"});
      attempt.was_alone = true;
    } else if (!is_fewer_already) {
      if (pixels < 2) return false;
      attempt.notes.push_back(
          {NoteCode::device_memory,
           fmt::format("the device had no memory for {} pixels at once; now at most {} are computed at once", pixels,
                       pixels / 2)});
      attempt.budget.pixels = pixels / 2;
    }
    in_flight_--;
    waiting_++;
    changed_.notify_all();
    changed_.wait(lock, [&] { return error_ || in_flight_ < most_in_flight_; });
    waiting_--;
    in_flight_++;
    // Another frame that waited may have left its buffers meanwhile.
    if (attempt.was_alone) lanes_.set_count(1);
    attempt.most_in_flight = most_in_flight_;
    return !error_;
  }

  void finish(std::size_t place, const MemoryBudget& budget, FrameReport&& report) {
    // What a frame takes is kept where a second device computes it again.
    if (run_.shot && !report.device_lost) run_.shot->done(report.frame);
    const Lock lock(mutex_);
    in_flight_--;
    // Later frames begin with what this one has learned.
    if (report.state == FrameState::done) budget_.pixels = std::min(budget_.pixels, budget.pixels);
    const bool ends_run = report.state == FrameState::failed && !run_.plan.settings().frames.keep_going;
    if (report.device_lost || ends_run) ended_ = true;
    if (const auto work = working_on_.find(report.frame); work != working_on_.end()) work->second.has_ended = true;
    finished_.emplace(place, std::move(report));
    changed_.notify_all();
  }

  void end_with(std::exception_ptr error) {
    const Lock lock(mutex_);
    if (!error_) error_ = std::move(error);
    ended_ = true;
    changed_.notify_all();
  }

  // The thread that runs the pipeline does this.

  /// The report of the first frame that was not told of; nothing once there is none any more. Meanwhile it tells how
  /// far the frames are.
  std::optional<FrameReport> next_report() {
    Lock lock(mutex_);
    while (!changed_.wait_for(lock, kTold, [&] { return finished_.contains(told_) || working_ == 0; })) {
      const auto frames = in_work();
      lock.unlock();
      if (take_progress_) take_progress_(frames);
      lock.lock();
    }
    const auto found = finished_.find(told_);
    if (found == finished_.end()) return {};
    told_++;
    working_on_.erase(found->second.frame);
    return std::move(finished_.extract(found).mapped());
  }

  /// The frames that are begun and not told of yet.
  std::vector<FrameProgress> in_work() const {
    std::vector<FrameProgress> frames;
    for (const auto& [frame, work] : working_on_)
      frames.push_back({frame, work.input, work.has_ended ? 0 : work.since.ms() / 1000, work.part, work.parts,
                        work.has_ended ? 1 : work.done});
    return frames;
  }

  /// A frame that is begun and not told of yet.
  struct Work {
    Stopwatch since;
    std::string input;
    int part = 0, parts = 1;
    double done = 0;  // share
    bool has_ended = false;
  };

  Lanes& lanes_;
  const RunContext& run_;
  const std::span<const int> frames_;
  const TakeReport& take_report_;
  const TakeProgress& take_progress_;

  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  MemoryBudget budget_;                          // of each frame in flight
  int most_in_flight_;                           // frames
  int in_flight_ = 0;                            // frames
  int waiting_ = 0;                              // frames to be computed again; they go before those not begun
  int working_ = 0;                              // threads that may still finish a frame
  std::size_t begun_ = 0;                        // frames
  std::size_t told_ = 0;                         // frames
  std::map<int, Work> working_on_;               // by frame
  std::map<std::size_t, FrameReport> finished_;  // by place; not told of yet
  bool ended_ = false;                           // no frame is begun any more
  std::exception_ptr error_;
};

}  // namespace

void run_pipeline(Lanes& lanes, const RunContext& run, const MemoryBudget& budget, std::span<const int> frames,
                  const TakeReport& take_report, const TakeProgress& take_progress) {
  Pipeline pipeline(lanes, run, budget, frames, take_report, take_progress);
  {
    std::vector<std::jthread> workers;
    pipeline.start(workers);
    pipeline.tell();
  }
  pipeline.rethrow_error();
}

}  // namespace alcove
