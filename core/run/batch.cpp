// Checks, the order of a run, and what ends it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/batch.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <thread>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/base/file.h"
#include "core/base/version.h"
#include "core/chain/aov.h"
#include "core/chain/chain.h"
#include "core/formats/color.h"
#include "core/frame/settle.h"
#include "core/run/pipeline.h"
#include "core/run/resume.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRadii = 8;
// on a GPU, beyond the threads: frames that wait for it while others are read and written
constexpr int kSpareLanes = 2;

/// What an estimate by its error asks for.
void check_tolerance(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.tolerance == 0) {
    if (wants(settings.output, &FrameOutputs::error))
      fail(ErrorKind::usage, "--aov error: only an estimate with a --tolerance knows its error");
    return;
  }
  if (e.estimator != Estimator::gtao) fail(ErrorKind::usage, "--tolerance: only of --estimator gtao");
  if (e.resolution != Resolution::full)
    fail(ErrorKind::usage, "--tolerance: the error is that of every pixel: give --resolution full");
}

void check_skipping(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.skip_tolerance == 0) return;
  if (searches_exactly(e))
    fail(ErrorKind::usage, "--skip-tolerance: an exact search leaves out nothing; --search steps does");
  if (e.estimator != Estimator::gtao && e.estimator != Estimator::bitmask)
    fail(ErrorKind::usage,
         "--skip-tolerance: only of --estimator gtao and bitmask, whose AO is weighted by the cosine");
  if (e.no_skip) fail(ErrorKind::usage, "--skip-tolerance and --no-skip: give only one of them");
}

/// What an exact search leaves to the others.
void check_search(const Settings& settings) {
  const auto& e = settings.estimator;
  if (!searches_exactly(e)) return;
  if (wants(settings.output, &FrameOutputs::bent_normal))
    fail(ErrorKind::usage, "--aov bent-normal: an exact search finds no open directions; --search steps does");
  for (const auto* view : debug_views_of(settings.output))
    if (view->source == DebugSource::tiles)
      fail(ErrorKind::usage, "--debug tiles: an exact search leaves out none; --search steps does");
  if (e.falloff != Falloff::none)
    fail(ErrorKind::usage,
         "--falloff: in an exact search all within the radius blocks fully; give --falloff none or --search steps");
  if (e.stride > 1)
    fail(ErrorKind::usage, "--stride {}: an exact search is made at every pixel; give --stride 1 or --search steps",
         e.stride);
}

/// Several radii, and what only some estimators give.
void check_scales(const Settings& settings) {
  const auto& e = settings.estimator;
  if (wants(settings.output, &FrameOutputs::bent_normal) && !has_bent_normals(e))
    fail(ErrorKind::usage, "--aov bent-normal: --estimator {} finds no open directions; gtao and bitmask do",
         e.estimator == Estimator::hbao ? "hbao" : "crytek");
  if (e.further_radii.empty()) return;
  const auto radii = radii_of(e);
  if (radii.size() > kMostRadii)
    fail(ErrorKind::usage, "--radius: there are {}, and at most {} scales", radii.size(), kMostRadii);
  if (const auto twice = std::ranges::adjacent_find(radii); twice != radii.end())
    fail(ErrorKind::usage, "--radius {} is there twice: give each scale once", *twice);
}

/// What goes into the shading of the AO.
void check_shading(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  if (e.fade_start.has_value() != e.fade_end.has_value())
    fail(ErrorKind::usage, "--fade-start and --fade-end belong together: depths in scene units");
  if (e.fade_end && *e.fade_end <= *e.fade_start)
    fail(ErrorKind::usage, "--fade-end {} is not beyond --fade-start {}", *e.fade_end, *e.fade_start);
  const bool has_albedo =
      !settings.input.albedo.empty() || settings.input.albedo_value || !settings.input.albedo_channels.empty();
  if (has_albedo && !o.multi_bounce)
    fail(ErrorKind::usage, "--albedo and --albedo-channels are for --multi-bounce: give it too");
  if (o.multi_bounce && o.composite.empty() && !wants(o, &FrameOutputs::color_ao))
    fail(ErrorKind::usage,
         "--multi-bounce shows in the AO with --ao-channels rgb, and in a --composite: ask for one of them");
  if (o.fog_density > 0 && o.composite.empty())
    fail(ErrorKind::usage, "--fog-density is for a composite: name its file with --composite");
}

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
}

/// All files that the run will write can be made; what killed runs have left beside them goes.
void prepare_outputs(const FramePlan& plan, const Settings& settings) {
  std::set<std::string> folders;
  std::unordered_map<std::string, const char*> options;  // by name
  const auto prepare = [&](const OutputFile& file) {
    if (const auto [known, is_new] = options.try_emplace(file.path, file.option); !is_new)
      fail(ErrorKind::usage, "{}: {} and {} of two frames name the same file", file.path, known->second, file.option);
    require_writable(file.path, file.option);
  };
  for (const int frame : plan.frames())
    for (const auto& file : outputs_of(plan.at(frame).output)) {
      prepare(file);
      folders.insert(folder_of(file.path));
    }
  for (const auto& file : reports_of(settings.output)) prepare(file);
  for (const auto& folder : folders) remove_unfinished(folder);
}

/// One frame of the sequence, settled: as which all others are read. The first that shows what is left open; null where
/// none can be read.
std::optional<FrameSource> settle_sequence(const FramePlan& plan) {
  std::optional<FrameSource> best;
  for (const int frame : plan.evidence()) {
    try {
      const Settings settings = plan.at(frame);
      FrameSource source = open_frame(settings, frame);
      settle_by_rows(source, settings.input);
      if (!best || source.has_evidence) best = std::move(source);
      if (best->has_evidence) break;
    } catch (const Error&) {
      // It is computed as all others are, and what is wrong with it is said then.
    }
  }
  return best;
}

int thread_count(const DeviceSettings& settings) {
  return settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
}

/// Frames that memory allows at once, of those that are left and at most `most`.
int frames_at_once(const std::optional<FrameSource>& source, const Settings& settings, std::size_t frames, int most) {
  if (!source || frames < 2) return 1;
  const std::uint64_t frame_bytes = pixel_memory(*source, settings).bytes * source->file_data.pixels();
  return int(std::clamp<std::uint64_t>(memory_for_frames(settings.device) / std::max<std::uint64_t>(1, frame_bytes), 1,
                                       std::min<std::uint64_t>(std::uint64_t(most), frames)));
}

/// Cores that a frame's own threads may take.
void share_cores(int threads, int lanes, bool is_chosen) {
  set_exr_threads(lanes == 1 ? threads : std::max(0, threads - lanes));
  // lavapipe's own variable; 0: no threads beside the one that submits.
  const int of_a_frame = threads / lanes;
  if (lanes > 1 || is_chosen)
    ::setenv("LP_NUM_THREADS", std::to_string(of_a_frame > 1 || lanes == 1 ? of_a_frame : 0).c_str(), 1);
}

}  // namespace

void check_settings(const Settings& settings) {
  if (settings.output.output.empty()) fail(ErrorKind::usage, "no output: name the AO file with -o FILE.exr");
  if (settings.input.input.empty() && settings.input.depth.empty() && settings.input.position.empty())
    fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  if (!settings.input.depth.empty() && !settings.input.position.empty())
    fail(ErrorKind::usage, "--depth and --position are two ways to say the same: give one");
  if (!settings.estimator.radius && needs_ao(settings.output))
    fail(ErrorKind::usage, "no radius: say with --radius how far occluders reach, in scene units");
  check_tolerance(settings);
  check_skipping(settings);
  check_search(settings);
  check_scales(settings);
  if (settings.estimator.estimator != Estimator::crytek && settings.estimator.bias >= 1)
    fail(ErrorKind::usage, "--bias {}: of every estimator but crytek it is the sine of an elevation, below 1",
         settings.estimator.bias);
  if (settings.estimator.falloff_end <= settings.estimator.falloff_start)
    fail(ErrorKind::usage, "--falloff-end {} is not above --falloff-start {}", settings.estimator.falloff_end,
         settings.estimator.falloff_start);
  if (settings.estimator.stride > 1 && settings.estimator.denoise != Denoise::bilateral)
    fail(ErrorKind::usage, "--stride {} leaves pixels to the denoiser: give --denoise bilateral, or --stride 1",
         settings.estimator.stride);
  if (settings.input.focal.has_value() != settings.input.aperture.has_value())
    fail(ErrorKind::usage, "--focal and --aperture belong together: focal length and width of the film back in mm");
  if (!settings.input.beauty.empty() && settings.output.composite.empty() && !settings.output.multi_bounce)
    fail(ErrorKind::usage, "--beauty is for a composite: name its file with --composite");
  check_shading(settings);
  if (settings.frames.chunk > settings.frames.chunks)
    fail(ErrorKind::usage, "--chunk {}/{}: there is no such chunk", settings.frames.chunk, settings.frames.chunks);
}

std::string options_digest(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& i = settings.input;
  // Every value on a line of its own, so that no two sets of values make one text.
  std::string text = kVersion;
  const auto add = [&](const auto&... values) { ((text += fmt::format("\n{}", values)), ...); };
  add(int(e.estimator), e.radius ? fmt::format("{}", fmt::join(radii_of(e), ",")) : "", int(e.falloff), e.falloff_start,
      e.falloff_end, e.slices, e.steps, e.intensity, e.power, e.seed, int(e.noise));
  add(e.fade_start.value_or(-1), e.fade_end.value_or(-1), e.roughness, settings.output.fog_density);
  add(settings.output.multi_bounce, i.albedo_value.value_or(-1));
  add(settings.output.aovs, int(settings.output.ao_channels), int(settings.output.aov_space));
  add(i.material_ao.empty(), i.material_ao_channel, i.albedo.empty(), i.albedo_channels);
  add(int(e.search), e.samples, e.bias, int(e.elevation), int(e.sample_kernel), int(e.range_check));
  add(int(e.thickness), e.thickness_length, e.tolerance, e.skip_tolerance, int(e.resolution), e.stride, int(e.denoise));
  add(e.denoise_radius, fmt::format("{}", fmt::join(e.denoise_kernel, ",")), e.denoise_depth_sigma);
  // The camera by what it says; where files lie is not part of it, so that a job has the same digest wherever its
  // folder is mounted.
  add(i.camera.empty() ? std::string() : read_text(i.camera, "camera", "--camera"));
  add(i.depth_channel, i.normal_channels, i.beauty_channels, i.layer, i.view, i.source);
  add(int(i.depth_kind), i.depth_scale, i.sky, int(i.normal_space), i.fov.value_or(0), i.focal.value_or(0),
      i.aperture.value_or(0), i.ortho_width.value_or(0));
  const DepthRange& range = i.depth_range;
  add(range.near.value_or(0), range.far.value_or(0), range.reversed, int(range.device), range.log_constant);
  const Region roi = i.roi.value_or(Region{});
  add(roi.x, roi.y, roi.width, roi.height);
  add(int(i.normal_encoding), i.flip_normal.x, i.flip_normal.y, i.flip_normal.z, i.position_channels,
      int(i.position_space), i.position.empty());
  add(int(settings.output.type));
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

namespace {

/// A run from its plan to its report.
class Batch {
 public:
  Batch(const Settings& settings, const RunWatch& watch) : settings_(settings), watch_(watch), plan_(settings) {}

  RunReport run() {
    const Stopwatch wall;
    report_.is_sequence = plan_.is_sequence();
    report_.missing = plan_.missing();
    if (!plan_.frames().empty()) {
      const Settings first = plan_.at(plan_.frames().front());
      check_files(first);
      prepare_outputs(plan_, settings_);
      report_.options = options_digest(first);
      first_camera_ = first.input.camera;
    }
    const std::vector<int> wanted = without_whole();
    if (watch_.begin) watch_.begin(report_, int(wanted.size()) + report_.kept);
    for (const auto& frame : report_.frames)
      if (watch_.frame) watch_.frame(frame);
    if (!wanted.empty()) compute(wanted);
    std::unordered_map<int, std::size_t> place;
    for (const int frame : plan_.frames()) place.emplace(frame, place.size());
    std::ranges::sort(report_.frames, {}, [&](const FrameReport& frame) { return place.at(frame.frame); });
    report_.dropped = int(plan_.frames().size()) - report_.done - report_.failed - report_.kept;
    report_.wall_s = wall.ms() / 1000;
    if (!settings_.output.stats.empty()) write_whole(settings_.output.stats, stats_json(report_));
    return std::move(report_);
  }

 private:
  /// The frames that are left to compute; the others are in the report.
  std::vector<int> without_whole() {
    if (!settings_.frames.resume || settings_.frames.overwrite) return plan_.frames();
    std::vector<int> wanted;
    for (const int frame : plan_.frames()) {
      const Settings settings = plan_.at(frame);
      if (!has_whole_outputs(settings,
                             settings.input.camera == first_camera_ ? report_.options : options_digest(settings))) {
        wanted.push_back(frame);
        continue;
      }
      FrameReport report;
      report.frame = frame;
      report.state = FrameState::kept;
      report.input = main_input(settings.input);
      report.output = settings.output.output;
      report_.frames.push_back(report);
      report_.kept++;
    }
    return wanted;
  }

  void compute(const std::vector<int>& frames) {
    const auto settled = plan_.is_sequence() ? settle_sequence(plan_) : std::nullopt;
    if (settled)
      for (const auto* said : {&settled->suspicious, &settled->notes})
        notes_of_all_.insert(notes_of_all_.end(), said->begin(), said->end());
    const int threads = thread_count(settings_.device);
    const int count = frames_at_once(settled, settings_, frames.size(), threads),
              gpu_count = frames_at_once(settled, settings_, frames.size(), threads + kSpareLanes);
    share_cores(threads, count, settings_.device.threads > 0);
    std::optional<DisplayTransform> transform;
    if (!settings_.output.preview.empty() && !settings_.output.composite.empty())
      transform.emplace(settings_.output.ocio);
    RunContext run{
        plan_,      settled ? &*settled : nullptr, transform ? &*transform : nullptr, {report_.options, ""}, {},
        watch_.stop};
    run_on_device(run, frames, count, gpu_count);
    if (!lost_) return;
    const Error loss = *std::exchange(lost_, std::nullopt);
    std::vector<int> left;
    std::ranges::copy_if(frames, std::back_inserter(left), [&](int frame) {
      return std::ranges::find(report_.frames, frame, &FrameReport::frame) == report_.frames.end();
    });
    run_on_device(run, left, count, gpu_count);
    if (lost_)
      report_.stop =
          Error(ErrorKind::device, fmt::format("{}, and so was a fresh one: {}", loss.what(), lost_->what()));
  }

  void run_on_device(RunContext& run, const std::vector<int>& frames, int count, int gpu_count) {
    const DeviceSettings& d = settings_.device;
    Lanes lanes({d.device, d.require_gpu, d.validate, !d.no_pipeline_cache}, count, gpu_count);
    const gpu::DeviceInfo& device = lanes.device().info();
    report_.device = run.provenance.device = device.name;
    report_.on_cpu_by_default = device.type == gpu::DeviceType::cpu && d.device == "auto";
    report_.at_once = lanes.count();
    run.room = {memory_for_frames(d) / std::uint64_t(lanes.count()), device.buffer_bytes};
    run_pipeline(lanes, run, frames, [&](FrameReport&& frame) { return take(std::move(frame)); });
    if (lanes.validation_messages())
      fail(ErrorKind::device, "--validate: the validation layer reported {} messages", lanes.validation_messages());
  }

  /// Whether the run goes on.
  bool take(FrameReport&& frame) {
    if (frame.device_lost) lost_ = frame.error;
    if (frame.state == FrameState::dropped || frame.device_lost) return !lost_;
    if (frame.state == FrameState::done) {
      report_.done++;
      for (const auto& note : std::exchange(notes_of_all_, {}))
        if (std::ranges::find(frame.notes, note) == frame.notes.end()) frame.notes.push_back(note);
    }
    if (frame.state == FrameState::failed) {
      report_.failed++;
      report_.failed_frames.push_back(frame.frame);
      if (!settings_.frames.keep_going && !report_.stop) report_.stop = frame.error;
    }
    if (watch_.frame) watch_.frame(frame);
    if (settings_.output.stats.empty()) frame.passes.clear(), frame.passes.shrink_to_fit();
    report_.frames.push_back(std::move(frame));
    return !report_.stop && !lost_;
  }

  const Settings& settings_;
  const RunWatch& watch_;
  const FramePlan plan_;
  std::string first_camera_;
  std::optional<Error> lost_;              // the device
  std::vector<std::string> notes_of_all_;  // of how a sequence is read; the first frame that is done carries them
  RunReport report_;
};

}  // namespace

RunReport run_frames(const Settings& settings, const RunWatch& watch) {
  check_settings(settings);
  return Batch(settings, watch).run();
}

}  // namespace alcove
