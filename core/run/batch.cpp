// The order of a run, and what ends it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/batch.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/chain/compute.h"
#include "core/chain/results/outputs.h"
#include "core/formats/color.h"
#include "core/formats/sheet.h"
#include "core/options/options.h"
#include "core/run/frame_run.h"
#include "core/run/frame_tally.h"
#include "core/run/memory.h"
#include "core/run/resume.h"
#include "core/run/run_files.h"
#include "core/run/run_preview.h"

namespace alcove {
namespace {

// The division of cores and memory.

constexpr int kWarmingThreads = 4;  // more would wait for the largest kernel

// On a GPU so many more frames than threads are in flight: they wait for it while others are read and written.
constexpr int kSpareLanes = 2;

/// The device of a run, with a lane for each frame in flight and the room that each may take.
class RunDevice {
 public:
  /// `settled`: how all frames are read; null: each by itself, one at a time. Fails with ErrorKind::usage or device
  /// where memory or buffers have no room for the frames around each.
  RunDevice(const FramePlan& plan, const FrameSource* settled, std::span<const int> frames)
      : settings_(plan.settings()), plan_(plan), settled_(settled), frames_(frames) {
    const DeviceSettings& d = settings_.device;
    lanes_.emplace(gpu::DeviceOptions{d.device, d.require_gpu, d.validate}, share_cores());
    MemoryBudget memory = memory_for_frames(settings_, info());
    if (settled_) {
      require_room_for_others(memory, plan_, *settled_, settings_, frames_);
      require_buffers_for_others(info().buffer_bytes, *settled_, settings_);
    }
    if (info().type != gpu::DeviceType::cpu) lanes_->set_count(lanes_within(memory, threads_ + kSpareLanes));
    // Where frames run side by side no core is free for it.
    if (lanes_->count() == 1 && threads_ > 1)
      warm_up_.emplace(lanes_->device(), settings_.estimator, settings_.output, std::min(threads_, kWarmingThreads));
    if (settled_) memory = without_shared_frames(memory, plan_, *settled_, settings_, frames_, lanes_->count());
    budget_ = budget_of_lane(memory, lanes_->count());
  }

  const gpu::DeviceInfo& info() { return lanes_->device().info(); }
  Lanes& lanes() { return *lanes_; }
  const MemoryBudget& budget() const { return budget_; }

 private:
  /// Divides the cores among the frames in flight on a CPU, and tells the codecs and lavapipe how many threads each
  /// has. A CPU device reads that when it is made, and so before anybody knows whether it is one. Gives the lanes.
  int share_cores() {
    const MemoryBudget memory = memory_of_host(settings_);
    const int lanes = lanes_within(memory, threads_), of_a_frame = threads_ / lanes;
    set_exr_memory(memory.bytes / kCodecPart / std::uint64_t(lanes));
    set_exr_threads(lanes == 1 ? threads_ : std::max(0, threads_ - lanes));
    // The variable is lavapipe's own; with 0 it makes no threads beside the one that submits.
    if (lanes > 1 || settings_.device.threads > 0)
      set_environment("LP_NUM_THREADS", std::to_string(of_a_frame > 1 || lanes == 1 ? of_a_frame : 0));
    return lanes;
  }

  /// The number of frames at once, up to `most`, for which the memory has room.
  int lanes_within(const MemoryBudget& memory, int most) const {
    if (!settled_ || frames_.size() < 2) return 1;
    return frames_at_once(memory, plan_, *settled_, settings_, frames_, most);
  }

  const Settings& settings_;
  const FramePlan& plan_;
  const FrameSource* const settled_;
  const std::span<const int> frames_;
  const int threads_ = threads_of(settings_.device);
  std::optional<Lanes> lanes_;
  MemoryBudget budget_;
  std::optional<WarmUp> warm_up_;
};

// The frames.

/// The frames of a run, whose reports are told and counted.
class Batch {
 public:
  Batch(RunPreview& look, InputIdentities& identities, const RunWatch& watch, RunReport& report)
      : look_(look), identities_(identities), watch_(watch), report_(report) {}

  /// Computes the frames; those that a lost device took with it once more, on a fresh one.
  void compute(const std::vector<int>& frames) {
    const Settings& settings = plan_.settings();
    const std::uint64_t bytes = memory_of_host(settings).bytes;
    set_exr_memory(bytes / kCodecPart);
    const auto settled = plan_.is_sequence() ? look_.settle(bytes) : std::nullopt;
    if (settled) note(FrameTally::notes_on(*settled, settings.input));
    std::optional<DisplayTransform> transform;
    if (shows_composite(settings.output))
      transform.emplace(settings.output.ocio, settings.output.display, settings.output.view_transform);
    if (plan_.has_contact_sheet()) sheet_.emplace(plan_.frames().size());
    std::optional<SharedFrames> shot;
    const bool takes_means = settings.input.accumulate > 0 && needs_ao(settings.output);
    if (takes_means || takes_others(settings.input)) shot.emplace(plan_, settled ? &*settled : nullptr, frames);
    RunContext run{look_,
                   plan_,
                   identities_,
                   settled ? &*settled : nullptr,
                   transform ? &*transform : nullptr,
                   shot ? &*shot : nullptr,
                   takes_means,
                   {report_.options, ""},
                   watch_.stop};
    if (sheet_) run.take_preview = [this](int frame, const ShownPicture& shown) { put(frame, "", {&shown, 1}); };

    run_on_device(run, frames);
    if (!lost_ || report_.stop) return;  // a frame that failed beside the loss has ended the run
    const Error loss = *std::exchange(lost_, std::nullopt);
    std::vector<int> left;
    std::ranges::copy_if(frames, std::back_inserter(left), [&](int frame) { return !ended_.contains(frame); });
    run_on_device(run, left);
    if (lost_)
      report_.stop =
          Error(ErrorKind::device, fmt::format("{}, and so was a fresh one: {}", loss.what(), lost_->what()));
  }

  /// Tells of the frames that are not to be computed.
  void tell_kept(const std::vector<int>& wanted) {
    const std::unordered_set<int> computed(wanted.begin(), wanted.end());
    for (const int frame : plan_.frames()) {
      if (computed.contains(frame)) continue;
      FrameReport report = report_of(plan_, frame);
      report.state = FrameState::kept;
      report_.kept++;
      if (watch_.frame) watch_.frame(report);
      keep(std::move(report));
    }
  }

  /// Writes the contact sheet of a run that came to its end. Fails with ErrorKind::output.
  void write_sheet() const {
    if (sheet_ && report_.dropped == 0) sheet_->write(plan_.settings().output.preview);
  }

  /// Puts the reports into the order of the plan: those of frames that were kept come first, and those of frames that
  /// were computed on a second device come last.
  void sort_reports() {
    std::unordered_map<int, std::size_t> place;
    for (const int frame : plan_.frames()) place.emplace(frame, place.size());
    std::ranges::sort(report_.frames, {}, [&](const FrameReport& frame) { return place.at(frame.frame); });
  }

  /// Adds notes on all frames.
  void note(const Notes& notes) {
    add_new(report_.notes, notes);
    if (watch_.noted) watch_.noted(report_);
  }

 private:
  void run_on_device(RunContext& run, const std::vector<int>& frames) {
    RunDevice device(plan_, run.settled, frames);
    report_.device = run.provenance.device = device.info().name;
    report_.on_cpu_by_default =
        device.info().type == gpu::DeviceType::cpu && lower_case(plan_.settings().device.device) == "auto";
    report_.at_once = device.lanes().count();
    run_pipeline(
        device.lanes(), run, device.budget(), frames, [this](FrameReport&& frame) { take(std::move(frame)); },
        watch_.working);
    report_.at_once = device.lanes().count();
    if (const int messages = device.lanes().validation_messages())
      fail(ErrorKind::device, "--validate: the validation layer reported {}",
           counted(std::size_t(messages), "message"));
  }

  /// Fills the frame's cell of the contact sheet.
  void put(int frame, const char* state, std::span<const ShownPicture> shown) {
    const auto place = std::ranges::find(plan_.frames(), frame) - plan_.frames().begin();
    sheet_->put(std::size_t(place), fmt::format("{}{}", frame, state), shown);
  }

  /// Counts a frame, and tells of it.
  void take(FrameReport&& frame) {
    if (frame.device_lost) lost_ = frame.error;
    if (frame.state == FrameState::dropped || frame.device_lost) return;
    if (frame.state == FrameState::done) {
      report_.done++;
      report_.warned += !warnings_of(frame.notes).empty();
    }
    if (frame.state == FrameState::failed) {
      report_.failed++;
      report_.failed_frames.push_back(frame.frame);
      if (sheet_) put(frame.frame, " failed", {});
      if (!plan_.settings().frames.keep_going && !report_.stop) report_.stop = frame.error;
    }
    ended_.insert(frame.frame);
    if (watch_.frame) watch_.frame(frame);
    keep(std::move(frame));
  }

  /// Reports are kept for --stats alone, so that the memory of a run does not grow with its frames without it.
  void keep(FrameReport&& frame) {
    if (!plan_.settings().output.stats.empty()) report_.frames.push_back(std::move(frame));
  }

  RunPreview& look_;
  InputIdentities& identities_;
  const RunWatch& watch_;
  RunReport& report_;
  const FramePlan& plan_ = look_.plan();
  std::optional<Sheet> sheet_;     // where --preview is one picture of all frames
  std::optional<Error> lost_;      // why the device was lost
  std::unordered_set<int> ended_;  // frames that were told of
};

}  // namespace

RunReport run_frames(RunPreview& look, const RunWatch& watch) {
  const Stopwatch wall;
  keep_no_spare_memory();
  RunReport report;
  report.notes = look.prepare();
  const FramePlan& plan = look.plan();
  const Settings& settings = plan.settings();
  report.is_sequence = plan.is_sequence();
  report.input = main_input(settings.input);
  report.missing = plan.missing();
  report.presets = settings.preset_files;
  const NewFolders new_folders(plan);
  refuse_overwriting(plan);
  prepare_outputs(plan);  // of a chunk without frames its reports
  if (!plan.frames().empty()) {
    require_endings(plan.at(plan.frames().front()).output);
    report.options = options_digest(settings);
  }
  InputIdentities identities(plan);
  const auto [wanted, notes] = frames_to_compute(plan, report.options, identities);
  add_new(report.notes, notes);
  Batch batch(look, identities, watch, report);
  make_folders(files_of(settings, FileRole::report), settings.output);
  if (watch.begin) watch.begin(report, int(plan.frames().size()));
  batch.tell_kept(wanted);
  if (!wanted.empty()) batch.compute(wanted);
  batch.sort_reports();
  report.dropped = int(plan.frames().size()) - report.done - report.failed - report.kept;
  batch.write_sheet();
  if (report.on_cpu_by_default && report.done)
    batch.note({{NoteCode::no_gpu, fmt::format("no GPU found; computed on {}", report.device)}});
  report.wall_s = wall.ms() / 1000;
  if (!settings.output.stats.empty()) {
    // Another chunk's run, refused meanwhile, may have taken the folder for its own and away.
    make_folders(files_of(settings, FileRole::report), settings.output);
    write_whole(settings.output.stats, stats_json(report));
  }
  return report;
}

}  // namespace alcove
