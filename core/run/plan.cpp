// Names with frame numbers, what is missing, chunks.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/plan.h"

#include <algorithm>
#include <filesystem>
#include <unordered_set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/chain/debug_view.h"
#include "core/run/frame_files.h"
#include "core/run/tiles.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kEvidenceFrames = 8;  // looked at, at the most, for one that shows what the files do not say

/// Every file that the settings name, inputs first.
const std::vector<NamedPath>& named_paths() {
  static const std::vector<NamedPath> paths = [] {
    std::vector<NamedPath> result;
    for (const auto& file : plane_file_options())
      result.push_back({file.option, [path = file.path](Settings& s) -> std::string& { return s.input.*path; }, false});
    const auto add = [&](const char* option, auto member, auto path, bool is_output) {
      result.push_back({option, [=](Settings& s) -> std::string& { return s.*member.*path; }, is_output});
    };
    add("--camera", &Settings::input, &InputSettings::camera, false);
    add("--output", &Settings::output, &OutputSettings::output, true);
    add("--composite", &Settings::output, &OutputSettings::composite, true);
    add("--preview", &Settings::output, &OutputSettings::preview, true);
    return result;
  }();
  return paths;
}

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// "shot.1001.exr" of one frame, "shot.1001.exr to shot.1100.exr" of several.
std::string span_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + " to " + last;
}

}  // namespace

FramePlan::FramePlan(const Settings& settings) : settings_(settings) {
  find_patterns();
  const std::vector<int> all = all_frames();
  refuse_shared_files(all);
  for (std::size_t i = 0; i < all.size() && evidence_.size() < kEvidenceFrames; i++)
    if (!is_sequence_ || has_inputs(all[i])) evidence_.push_back(all[i]);
  find_inputs(chunk_of(all, settings.frames.chunk, settings.frames.chunks));
}

void FramePlan::find_patterns() {
  const auto find = [&](bool outputs) {
    for (const auto& path : named_paths()) {
      const std::string& text = path.of(settings_);
      if (path.is_output != outputs || text.empty() || (!outputs && exists(text))) continue;
      if (const auto name = frame_pattern(text)) patterns_.push_back({path, *name});
    }
  };
  find(false);
  is_sequence_ = !settings_.frames.frames.empty() || !patterns_.empty();
  if (is_sequence_) find(true);
}

std::vector<int> FramePlan::all_frames() const {
  if (!settings_.frames.frames.empty()) return parse_frames(settings_.frames.frames);
  const auto input = std::ranges::find_if(patterns_, [](const Pattern& pattern) { return !pattern.path.is_output; });
  if (input == patterns_.end()) return {frame_number_of(main_input(settings_.input))};
  return frames_on_disk(input->name, input->path.option);
}

void FramePlan::refuse_shared_files(const std::vector<int>& all) const {
  Settings whole = settings_;
  for (const auto& path : named_paths()) {
    const bool is_pattern =
        std::ranges::any_of(patterns_, [&](const Pattern& pattern) { return pattern.path.option == path.option; });
    if (path.is_output && all.size() > 1 && !path.of(whole).empty() && !is_pattern)
      fail(ErrorKind::usage,
           "{} {}: all {} frames would be written to it: put a place for the frame number into its name, such as %04d",
           path.option, path.of(whole), all.size());
  }
  std::unordered_set<std::string> inputs;
  for (const auto& pattern : patterns_)
    if (!pattern.path.is_output)
      for (const int frame : all) inputs.insert(pattern.name.path(frame));
  for (const auto& pattern : patterns_)
    for (const int frame : all)
      if (const auto path = pattern.name.path(frame + settings_.frames.output_offset);
          pattern.path.is_output && inputs.contains(path))
        fail(ErrorKind::usage, "{}: {} of frame {} would overwrite an input", path, pattern.path.option, frame);
  for (const auto& report : reports_of(settings_.output))
    if (inputs.contains(report.path))
      fail(ErrorKind::usage, "{}: {} would overwrite an input", report.path, report.option);
}

bool FramePlan::has_inputs(int frame) const {
  return std::ranges::all_of(
      patterns_, [&](const Pattern& pattern) { return pattern.path.is_output || exists(pattern.name.path(frame)); });
}

void FramePlan::find_inputs(const std::vector<int>& chunk) {
  std::string complaint;
  for (const auto& pattern : patterns_) {
    if (pattern.path.is_output) continue;
    std::vector<int> absent;
    std::ranges::copy_if(chunk, std::back_inserter(absent),
                         [&](int frame) { return !exists(pattern.name.path(frame)); });
    if (absent.empty()) continue;
    complaint +=
        fmt::format("{}{}: {} of {} frames are missing: {} ({})", complaint.empty() ? "" : "; ", pattern.path.option,
                    absent.size(), chunk.size(), frames_text(absent), pattern.name.path(absent.front()));
  }
  if (!complaint.empty() && settings_.frames.missing == Missing::error)
    fail(ErrorKind::input, "{}; --missing skip leaves them out, --frames says which to compute", complaint);
  for (const int frame : chunk) (has_inputs(frame) ? frames_ : missing_).push_back(frame);
  if (!chunk.empty() && frames_.empty()) fail(ErrorKind::input, "{}; there is nothing to compute", complaint);
}

Settings FramePlan::at(int frame) const {
  Settings settings = settings_;
  for (const auto& pattern : patterns_)
    pattern.path.of(settings) =
        pattern.name.path(pattern.path.is_output ? frame + settings_.frames.output_offset : frame);
  return settings;
}

int frame_number_of(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  const std::size_t last = stem.find_last_not_of("0123456789");
  const std::string digits = last == stem.npos ? stem : stem.substr(last + 1);
  return digits.empty() || digits.size() > 9 ? 0 : std::stoi(digits);
}

const std::string& main_input(const InputSettings& settings) {
  return !settings.input.empty() ? settings.input : settings.depth.empty() ? settings.position : settings.depth;
}

std::vector<OutputFile> outputs_of(const OutputSettings& output) {
  std::vector<OutputFile> files{
      {"--output", output.output}, {"--composite", output.composite}, {"--preview", output.preview}};
  for (const auto* view : debug_views_of(output)) files.push_back({"--debug", debug_path(output, *view)});
  std::erase_if(files, [](const OutputFile& file) { return file.path.empty(); });
  return files;
}

std::vector<OutputFile> reports_of(const OutputSettings& output) {
  std::vector<OutputFile> files{{"--stats", output.stats},
                                {"--log-json", output.log_json == "-" ? "" : output.log_json}};
  std::erase_if(files, [](const OutputFile& file) { return file.path.empty(); });
  return files;
}

std::vector<int> chunk_of(const std::vector<int>& frames, int chunk, int chunks) {
  const auto at = [&](int i) {
    return frames.begin() + std::ptrdiff_t(frames.size() * std::size_t(i) / std::size_t(chunks));
  };
  return {at(chunk - 1), at(chunk)};
}

std::string plan_text(const Settings& settings) {
  const FramePlan plan(settings);
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += printable(fmt::format("{:<14}{}", name, value)) + "\n";
  };
  line("frames",
       plan.frames().empty() ? "none" : fmt::format("{}: {}", plan.frames().size(), frames_text(plan.frames())));
  if (!plan.missing().empty())
    line("missing", fmt::format("{}: {}, left out", plan.missing().size(), frames_text(plan.missing())));
  if (plan.frames().empty()) return text;
  Settings first = plan.at(plan.frames().front()), last = plan.at(plan.frames().back());
  for (const auto& path : named_paths())
    if (!path.of(first).empty()) line(path.option, span_text(path.of(first), path.of(last)));

  const FrameSource source = open_frame(first, plan.frames().front());
  std::vector<std::string> channels;
  for (const auto& plane : source.planes.entries)
    for (const auto& channel : plane) channels.push_back(channel.channel);
  line("channels", fmt::format("{}", fmt::join(channels, ", ")));
  line("camera",
       fmt::format("{}, {:.6g} x {:.6g} px {}", source.camera.orthographic ? "orthographic" : "perspective",
                   source.camera.fx, source.camera.fy, source.camera.orthographic ? "a scene unit" : "focal length"));
  const std::uint64_t bytes = pixel_memory(source, first).bytes * source.file_data.pixels(),
                      all = memory_for_frames(first.device);
  line("size", to_string(written_of(source)));
  line("memory", fmt::format("{} MiB a frame, {} MiB for frames: {}", bytes >> 20, all >> 20,
                             bytes > all ? "in tiles"
                                         : fmt::format("up to {} at once", all / std::max<std::uint64_t>(1, bytes))));
  return text;
}

}  // namespace alcove
