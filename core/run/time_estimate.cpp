// Reads, computes and encodes windows about the middle of a frame, and scales what they take.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/time_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/stopwatch.h"
#include "core/base/system.h"
#include "core/frame/settle_rows.h"
#include "core/run/memory_plan.h"
#include "core/run/shot.h"
#include "core/run/tiles.h"

namespace alcove {
namespace {

constexpr double kEnoughMs = 600;         // a window that takes so long is large enough
constexpr double kLeastPixels = 1 << 14;  // of the first window
constexpr double kGrowth = 4;             // from one window's pixels to the next one's
constexpr double kMostPixels = 1 << 23;   // of the last window, so that it fits into memory
// An exact search of a larger frame costs more per pixel, as far as its radius reaches: at most as the square root, of
// which half is expected.
constexpr double kSteepest = 1.25;

/// What a window takes, in milliseconds.
struct Sample {
  double pixels = 0, rows = 0;  // rows that were decoded, over the whole width of the file
  double read = 0, compute = 0, write = 0;
  double warp = 0;  // what others see, however small the window is
};

/// What frames take from others.
struct FromOthers {
  std::vector<OtherView> seen = {};  // by one frame, of the frames beside it
  double views = 0;                  // times as many of them that each frame of the run takes
  std::size_t prepared = 0;          // frames that the run prepares for others
  double ms = 0;                     // which that takes, and to tell what moves in them
};

/// How often the run does what was done for one frame.
struct ShotCounts {
  std::size_t prepared = 0, witnesses = 0, views = 0;
};

ShotCounts counts_of(const FramePlan& plan, const std::vector<int>& frames) {
  std::set<int> prepared, judged;
  ShotCounts counts;
  for (const int frame : frames) {
    const std::vector<int> around = plan.around(frame, around_of(plan.at(frame).input)).there;
    if (around.empty()) continue;
    const std::vector<int> all = frames_seen_for(plan, frame);
    prepared.insert(frame);
    prepared.insert(all.begin(), all.end());
    judged.insert(around.begin(), around.end());
    counts.views += around.size();
  }
  counts.prepared = prepared.size();
  for (const int frame : judged) counts.witnesses += judges_of(plan, frame).size();
  return counts;
}

/// Prepares the frames beside one, and its other views, and counts how many more the run takes.
FromOthers time_others(gpu::Recorder& gpu, const TimedRun& run, const FrameSource& source, int frame) {
  if (!takes_others(run.settings.input)) return {};
  Settings beside = run.settings;
  beside.input.around = std::min(1, around_of(beside.input));
  beside.input.around_all = false;
  const FramePlan plan(beside);
  const std::vector<int> one{frame};
  SharedFrames shared(plan, &source, one);
  PreparedOthers took;
  const Stopwatch preparing;
  Others others = shared.others_of(gpu, source, frame, took);
  const double ms = preparing.ms();
  if (others.seen.empty()) return {};
  double still = 0;
  for (const auto& pass : took.passes) still += pass.name == "still" ? pass.ms : 0;
  const std::size_t frames = run.frames.size(), views = others.views.size();
  const ShotCounts here = counts_of(plan, one), all = counts_of(run.plan, run.frames);
  const double of_each = (ms - still) / double(here.prepared + views);
  FromOthers result{std::move(others.seen), 0, all.prepared + views * frames, 0};
  result.views = double(all.views + views * frames) / double(frames * result.seen.size());
  result.ms = of_each * double(result.prepared) +
              still * double(all.witnesses) / double(std::max<std::size_t>(1, here.witnesses));
  return result;
}

/// About `pixels` pixels of a window, about its middle and of its shape.
Window middle_of(const Window& whole, double pixels) {
  const double part = std::min(1.0, std::sqrt(pixels / double(whole.pixels())));
  const int width = std::max(1, int(part * whole.width)), height = std::max(1, int(part * whole.height));
  return {whole.x + (whole.width - width) / 2, whole.y + (whole.height - height) / 2, width, height};
}

Sample time_window(gpu::Recorder& gpu, FrameSource& source, const Settings& settings, int frame, const Window& window,
                   const FromOthers& others) {
  Sample sample{double(window.pixels())};
  source.data = window;
  source.region = window;
  const Stopwatch reading;
  FrameRows rows(source, memory_of(source, settings).on_host(window), existing_folder_of(settings.output.output));
  const auto rows_before = source.rows_read;
  FrameInputs inputs = load_frame(gpu, source, settings, frame, &rows);
  inputs.others = others.seen;
  sample.read = reading.ms();
  sample.rows = double(source.rows_read - rows_before);
  const FrameOutputs outputs = run_chain(gpu, inputs, settings.estimator, settings.output);
  gpu.run();
  for (const auto& pass : gpu.passes()) (pass.name == "warp" ? sample.warp : sample.compute) += pass.ms;
  const Stopwatch writing;
  FrameWriter writer(source, settings, {});  // which takes with it what was not finished
  writer.write(result_planes(outputs, window, settings.output));
  sample.write = writing.ms();
  return sample;
}

/// The milliseconds of a whole from those of two of its parts.
double scaled(double small_ms, double large_ms, const Sample& small, const Sample& large, double pixels) {
  double steepness = 1;
  if (small.pixels < large.pixels && small_ms > 0 && large_ms > small_ms)
    steepness = std::clamp(std::log(large_ms / small_ms) / std::log(large.pixels / small.pixels), 1.0, kSteepest);
  return large_ms * std::pow(pixels / large.pixels, steepness);
}

std::string duration_text(double seconds) {
  if (seconds < 10) return fmt::format("{:.1f} s", seconds);
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

/// The settings with outputs that may be begun anywhere. What is wrong there says nothing of the run.
Settings with_scratch(Settings settings) {
  std::error_code error;
  const std::string folder = std::filesystem::temp_directory_path(error).string();
  if (error) fail(ErrorKind::output, "no temporary folder: {}", error.message());
  settings.output.output = folder + "/alcove-dry-run.exr";
  if (!settings.output.composite.empty()) settings.output.composite = folder + "/alcove-dry-run-composite.exr";
  return settings;
}

/// The frames that the run estimates: more than it computes where these are means of many.
std::size_t estimated_in(const TimedRun& run) {
  if (run.settings.input.accumulate == 0) return run.frames.size();
  std::set<int> estimated;
  for (const int frame : run.frames) {
    const auto there = run.plan.accumulated(frame).there;
    estimated.insert(there.begin(), there.end());
  }
  return estimated.size();
}

std::string estimate(const TimedRun& run) {
  // A sequence more often begins or ends with nothing than it has nothing in its middle.
  const int frame = run.frames[run.frames.size() / 2];
  const std::size_t estimated = estimated_in(run);
  const Settings settings = with_scratch(run.plan.at(frame));
  FrameSource source = open_frame(settings, frame);
  const DeviceSettings& d = settings.device;
  gpu::Device device({d.device, d.require_gpu, d.validate, !d.no_pipeline_cache});
  gpu::Recorder gpu(device);
  const Window whole = written_of(source);
  if (!source.settled) settle_by_rows(source, settings.input);

  const FromOthers others = time_others(gpu, run, source, frame);

  // As much of the memory as one frame may take.
  const FrameMemory memory = memory_of(source, settings);
  const double room_px = double(memory_of_host(d).host_bytes) * double(whole.pixels()) / double(memory.on_host(whole)),
               most = std::min(kMostPixels, std::max(room_px, kLeastPixels));

  Sample before, last;
  for (double pixels = kLeastPixels;; pixels *= kGrowth) {
    const Window window = middle_of(whole, std::min(pixels, most));
    before = std::exchange(last, time_window(gpu, source, settings, frame, window, others));
    const bool is_all = last.pixels >= 0.99 * double(whole.pixels()) || pixels >= most;
    if (is_all || last.read + last.compute + last.write > kEnoughMs) break;
  }
  if (before.pixels == 0) before = last;

  const double pixels = double(whole.pixels()), read = last.read * whole.height / std::max(last.rows, 1.0),
               files = std::max(read, last.read) + last.write * pixels / last.pixels,
               compute = scaled(before.compute, last.compute, before, last, pixels) + last.warp * others.views;
  const bool is_cpu = device.info().type == gpu::DeviceType::cpu;
  const int threads = d.threads > 0 ? d.threads : core_count();
  const auto room = frames_in(memory_for_frames(d, device.info()), memory, whole);
  const double at_once = double(std::min({room, std::uint64_t(run.frames.size()), std::uint64_t(threads)}));
  // A GPU computes while other frames are read and written; on a CPU all of it takes the same cores.
  const double each = is_cpu || at_once == 1 ? compute + files / at_once : std::max(compute, files / at_once);
  const std::string for_others = others.prepared == 0 ? ""
                                                      : fmt::format(" and {} for the {} frames that they take from",
                                                                    duration_text(others.ms / 1000), others.prepared);
  const std::string for_means =
      run.settings.input.accumulate == 0
          ? ""
          : fmt::format(", {} estimated for {}, without what the means take,", estimated, run.frames.size());
  return fmt::format(
      "about {}: {} per frame{}{} on {}, by computing {} of {}",
      duration_text((each * double(estimated) + others.ms) / 1000), duration_text(each / 1000), for_others, for_means,
      device.info().name,
      last.pixels >= 0.99 * pixels ? "all" : fmt::format("{}x{} pixels", source.data.width, source.data.height),
      std::filesystem::path(source.depth_path()).filename().string());
}

}  // namespace

std::string time_text(const TimedRun& run) {
  if (run.frames.empty()) return "none: all outputs are whole";
  try {
    return estimate(run);
  } catch (const Error& error) {
    // What is wrong with the frame or the settings ends the run too; a device may be there elsewhere, and all outputs
    // of an estimate are scratch files.
    if (error.kind() != ErrorKind::device && error.kind() != ErrorKind::output) throw;
    return fmt::format("unknown: {}", error.what());
  }
}

}  // namespace alcove
