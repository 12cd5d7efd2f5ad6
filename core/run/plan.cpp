// Finds frames by the names of their files, tells what is missing, and cuts chunks.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/plan.h"

#include <algorithm>
#include <filesystem>
#include <unordered_set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/chain/debug_view.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

// The most frames that are looked at for one that shows what the files do not say.
constexpr std::size_t kEvidenceFrames = 8;

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

}  // namespace

std::span<const NamedPath> named_paths() {
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

}  // namespace alcove
