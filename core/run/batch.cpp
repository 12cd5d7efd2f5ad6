// The order of a run, and what ends it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/batch.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/chain/chain.h"
#include "core/chain/results/outputs.h"
#include "core/chain/warm_up.h"
#include "core/formats/color.h"
#include "core/options/options.h"
#include "core/run/first_look.h"
#include "core/run/frame_run.h"
#include "core/run/memory.h"
#include "core/run/pipeline.h"
#include "core/run/resume.h"

namespace alcove {
namespace {

constexpr int kWarmingThreads = 4;  // more would wait for the largest kernel

namespace fs = std::filesystem;

// On a GPU so many more frames than threads are in flight: they wait for it while others are read and written.
constexpr int kSpareLanes = 2;

/// No output is an input, or another output.
void check_files(const Settings& settings) {
  auto outputs = outputs_of(settings.output);
  const auto reports = reports_of(settings.output);
  outputs.insert(outputs.end(), reports.begin(), reports.end());
  for (std::size_t i = 0; i < outputs.size(); i++) {
    require_no_input(outputs[i].path, outputs[i].option, input_files(settings.input));
    for (std::size_t j = 0; j < i; j++)
      if (same_file(outputs[j].path, outputs[i].path))
        fail(ErrorKind::usage, "{}: {} and {} name the same file", outputs[i].path, outputs[j].option,
             outputs[i].option);
  }
  require_endings(settings.output);
}

/// The folders of a run's files that are not there before it. At its end those that it has made and put nothing into
/// are gone again, so that nothing is left of a run that is refused only once its frames are read.
class NewFolders {
 public:
  NewFolders(const FramePlan& plan, const Settings& settings) {
    for (const int frame : plan.frames()) add(outputs_of(plan.at(frame).output));
    add(reports_of(settings.output));
  }
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders() {
    std::error_code not_empty;
    for (auto folder = folders_.rbegin(); folder != folders_.rend(); folder++) fs::remove(*folder, not_empty);
  }

 private:
  void add(const std::vector<OutputFile>& files) {
    std::error_code error;
    for (const auto& file : files)
      for (std::string folder = folder_of(file.path);
           !folders_.contains(folder) && fs::status(folder, error).type() == fs::file_type::not_found;
           folder = folder_of(folder))
        folders_.insert(folder);
  }

  std::set<std::string> folders_;  // what lies in another one comes after it
};

/// All files that the run will write can be made; what killed runs have left beside them goes.
void prepare_outputs(const FramePlan& plan, const Settings& settings) {
  std::set<std::string> folders;
  std::unordered_map<std::string, const char*> options;  // by name
  const auto prepare = [&](const OutputFile& file) {
    if (const auto [known, is_new] = options.try_emplace(file.path, file.option); !is_new)
      fail(ErrorKind::usage, "{}: {} and {} of two frames name the same file", file.path, known->second, file.option);
    if (settings.output.no_mkdir)
      require_writable(file.path, file.option);
    else
      require_makeable(file.path, file.option);
  };
  for (const int frame : plan.frames())
    for (const auto& file : outputs_of(plan.at(frame).output)) {
      prepare(file);
      folders.insert(folder_of(file.path));
    }
  for (const auto& file : reports_of(settings.output)) prepare(file);
  for (const auto& folder : folders) remove_unfinished(folder);
}

int thread_count(const DeviceSettings& settings) { return settings.threads > 0 ? settings.threads : core_count(); }

/// Divides the cores among the frames in flight, and tells the codecs and lavapipe how many threads are left for each.
/// `is_chosen` says that the user named the number of threads.
void share_cores(int threads, int lanes, bool is_chosen) {
  set_exr_threads(lanes == 1 ? threads : std::max(0, threads - lanes));
  const int of_a_frame = threads / lanes;
  // The variable is lavapipe's own; with 0 it makes no threads beside the one that submits.
  if (lanes > 1 || is_chosen)
    set_environment("LP_NUM_THREADS", std::to_string(of_a_frame > 1 || lanes == 1 ? of_a_frame : 0));
}

/// A run from its plan to its report.
class Batch {
 public:
  /// `notes` are on all frames.
  Batch(const Settings& settings, Notes notes, const RunWatch& watch)
      : settings_(settings), watch_(watch), plan_(settings) {
    report_.notes = std::move(notes);
  }

  RunReport run() {
    const Stopwatch wall;
    report_.is_sequence = plan_.is_sequence();
    report_.input = main_input(settings_.input);
    add_new(report_.notes, notes_on_names(plan_, settings_));
    report_.missing = plan_.missing();
    const NewFolders new_folders(plan_, settings_);
    if (!plan_.frames().empty()) {
      const Settings first = plan_.at(plan_.frames().front());
      check_files(first);
      prepare_outputs(plan_, settings_);
      report_.options = options_digest(first);
    }
    const std::vector<int> wanted = frames_to_compute(plan_, settings_);
    make_folders(reports_of(settings_.output), settings_.output);
    if (watch_.begin) watch_.begin(report_, int(plan_.frames().size()));
    tell_kept(wanted);
    if (!wanted.empty()) compute(wanted);
    sort_reports();
    report_.dropped = int(plan_.frames().size()) - report_.done - report_.failed - report_.kept;
    if (report_.on_cpu_by_default && report_.done)
      note({{NoteCode::no_gpu, fmt::format("no GPU found; computed on {}", report_.device)}});
    report_.wall_s = wall.ms() / 1000;
    if (!settings_.output.stats.empty()) {
      // Another chunk's run, refused meanwhile, may have taken the folder for its own and away.
      make_folders(reports_of(settings_.output), settings_.output);
      write_whole(settings_.output.stats, stats_json(report_));
    }
    return std::move(report_);
  }

 private:
  /// Tells of the frames that are not wanted any more.
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

  /// Puts the reports into the order of the plan: those of frames that were kept come first, and those of frames that
  /// were computed on a second device come last.
  void sort_reports() {
    std::unordered_map<int, std::size_t> place;
    for (const int frame : plan_.frames()) place.emplace(frame, place.size());
    std::ranges::sort(report_.frames, {}, [&](const FrameReport& frame) { return place.at(frame.frame); });
  }

  /// Takes what was noted of all frames.
  void note(const Notes& notes) {
    add_new(report_.notes, notes);
    if (watch_.noted) watch_.noted(report_);
  }

  void compute(const std::vector<int>& frames) {
    const std::uint64_t bytes = memory_of_host(settings_.device).host_bytes;
    set_exr_memory(bytes / kCodecPart);
    const auto settled = plan_.is_sequence() ? settle_first(plan_, bytes) : std::nullopt;
    if (settled) note(FrameTally::notes_on(*settled));
    std::optional<DisplayTransform> transform;
    if (shows_composite(settings_.output)) {
      const OutputSettings& output = settings_.output;
      transform.emplace(output.ocio, output.display, output.view_transform);
    }
    std::optional<SharedFrames> shot;
    const bool takes_means = settings_.input.accumulate > 0 && needs_ao(settings_.output);
    if (takes_means || takes_others(settings_.input)) shot.emplace(plan_, settled ? &*settled : nullptr, frames);
    RunContext run{plan_,
                   identities_,
                   settled ? &*settled : nullptr,
                   transform ? &*transform : nullptr,
                   shot ? &*shot : nullptr,
                   takes_means,
                   {report_.options, ""},
                   watch_.stop};

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

  /// The number of frames that are computed at once, of those that are left.
  int lanes_for(const RunContext& run, std::span<const int> frames, const RunMemory& memory, int most) const {
    if (!run.settled || frames.size() < 2) return 1;
    const FrameMemory frame = memory_with_others(plan_, *run.settled, settings_);
    int lanes = int(std::min(frames.size(), std::size_t(most)));
    const auto has_room = [&] {
      const RunMemory left = beside_shot(memory, plan_, *run.settled, settings_, frames, lanes);
      return frames_in(left, frame, run.settled->file_data) >= std::uint64_t(lanes);
    };
    while (lanes > 1 && !has_room()) lanes--;
    return lanes;
  }

  void run_on_device(RunContext& run, const std::vector<int>& frames) {
    const DeviceSettings& d = settings_.device;
    // A CPU device reads its number of threads when it is made, and so before anybody knows whether it is one.
    const int threads = thread_count(d);
    const RunMemory of_host = memory_of_host(d);
    const int cpu_lanes = lanes_for(run, frames, of_host, threads);
    set_exr_memory(of_host.host_bytes / kCodecPart / std::uint64_t(cpu_lanes));
    share_cores(threads, cpu_lanes, d.threads > 0);
    Lanes lanes({d.device, d.require_gpu, d.validate, !d.no_pipeline_cache}, cpu_lanes);

    const gpu::DeviceInfo& device = lanes.device().info();
    const bool is_cpu = device.type == gpu::DeviceType::cpu;
    RunMemory memory = memory_for_frames(d, device);
    if (run.settled) require_room_for_others(memory, plan_, *run.settled, settings_, frames);
    if (run.settled) require_buffers_for_others(device.buffer_bytes, *run.settled, settings_);
    if (!is_cpu) lanes.set_count(lanes_for(run, frames, memory, threads + kSpareLanes));
    // Where frames run side by side no core is free for it.
    std::optional<WarmUp> warm_up;
    if (lanes.count() == 1 && threads > 1)
      warm_up.emplace(lanes.device(), settings_.estimator, settings_.output, std::min(threads, kWarmingThreads));
    report_.device = run.provenance.device = device.name;
    report_.on_cpu_by_default = is_cpu && lower_case(d.device) == "auto";
    report_.at_once = lanes.count();
    if (run.settled) memory = beside_shot(memory, plan_, *run.settled, settings_, frames, lanes.count());

    run_pipeline(lanes, run, room_of_lane(memory, lanes.count(), device), frames,
                 {[this](const FrameReport& frame) { return ends(frame); },
                  [this](FrameReport&& frame) { take(std::move(frame)); }, watch_.working});
    report_.at_once = lanes.count();
    if (lanes.validation_messages())
      fail(ErrorKind::device, "--validate: the validation layer reported {} messages", lanes.validation_messages());
  }

  /// Whether no frame is begun after this one. Called by any thread.
  bool ends(const FrameReport& frame) const {
    return frame.device_lost || (frame.state == FrameState::failed && !settings_.frames.keep_going);
  }

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
      if (!settings_.frames.keep_going && !report_.stop) report_.stop = frame.error;
    }
    ended_.insert(frame.frame);
    if (watch_.frame) watch_.frame(frame);
    keep(std::move(frame));
  }

  /// Reports are kept for --stats alone, so that the memory of a run does not grow with its frames without it.
  void keep(FrameReport&& frame) {
    if (!settings_.output.stats.empty()) report_.frames.push_back(std::move(frame));
  }

  const Settings& settings_;
  const RunWatch& watch_;
  const FramePlan plan_;
  InputIdentities identities_{plan_};
  std::optional<Error> lost_;      // why the device was lost
  std::unordered_set<int> ended_;  // frames that were told of
  RunReport report_;
};

}  // namespace

RunReport run_frames(const Settings& settings, const RunWatch& watch) {
  check_settings(settings);
  keep_no_spare_memory();
  Notes notes;
  const Settings known = with_proposed_radius(settings, notes);
  return Batch(known, notes, watch).run();
}

}  // namespace alcove
