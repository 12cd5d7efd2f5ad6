// `alcove run`: options in, frames out, one line of summary.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "core/base/file.h"
#include "core/base/frame_list.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/frame/raw_plane.h"
#include "core/options/files.h"
#include "core/run/batch.h"
#include "core/run/first_look.h"

namespace alcove {
namespace {

/// The arguments but for empty values, which say nothing, and the options that take them.
Words without_empty(const Words& arguments) {
  const auto rows = run_syntax().rows;
  const auto takes_value = [&](const std::string& word) {
    return std::ranges::any_of(
        rows, [&](const OptionRow& row) { return !row.is_flag() && std::ranges::count(split(row.name), word) > 0; });
  };
  Words kept;
  for (const auto& argument : arguments)
    if (!argument.empty())
      kept.push_back(argument);
    else if (!kept.empty() && takes_value(kept.back()))
      kept.pop_back();
  return kept;
}

/// Prints a line for each missing option, and the command that has all of them. Returns whether none is missing.
bool has_all(FirstLook& look, const Settings& settings, const std::vector<std::string>& arguments) {
  const MissingOptions missing = look.missing_options();
  if (!missing.any()) return true;
  std::string command = "alcove run";
  if (missing.input) command += " frame.exr";
  for (const auto& argument : without_empty(arguments)) command += " " + for_shell(argument);
  if (missing.output) command += " -o " + for_shell(usual_output(main_input(settings.input), "ao", ".exr"));
  if (missing.camera) command += " --camera CAMERA.json";
  if (missing.lacks_matrix) command += " --normal none";
  if (missing.radius)
    command += " --radius " + (missing.proposed_radius ? fmt::format("{}", *missing.proposed_radius) : "auto");
  print_error("alcove: error: missing:\n");
  for (const auto& sentence : missing.sentences()) print_error("  {}\n", printable(sentence));
  print_error("such as:\n{}\n", printable(command));
  return false;
}

/// Fails where two frames of a list would write one file, or one of them what another reads.
void require_places(const Settings& settings, const std::vector<ListedFrame>& frames) {
  const std::string& list = settings.input.input;
  FileUses uses;
  for (const auto& frame : frames) {
    uses.add_input({"INPUT", frame.input});
    uses.add_input({"--camera", frame.camera});
    for (const auto& file : files_of(settings, FileRole::input))
      uses.add_input({file.option, with_name(file.path, frame.name)});
  }
  for (const FileRole role : {FileRole::output, FileRole::report})
    for (const auto& file : files_of(settings, role)) {
      if (file.path.find(kNamePlace) == file.path.npos)
        fail(ErrorKind::usage, "{} {}: {}", file.option, file.path, why_no_place(list));
      for (const auto& frame : frames)
        uses.add_output({file.option, with_name(file.path, frame.name)}, " of frame " + frame.name);
    }
}

/// Whether an option is typed, or its key behind --set.
bool is_typed(const Words& arguments, const std::string& option) {
  const std::string key = option.substr(2) + "=";
  return std::ranges::any_of(arguments, [&](const auto& word) {
    return word.starts_with(option) || word.starts_with(key) || word.starts_with("--set=" + key);
  });
}

/// The command for a frame of a list: its file, and its camera and radius unless others are typed.
Words words_of_frame(const Words& arguments, const Settings& settings, const ListedFrame& frame) {
  Words words;
  for (const auto& word : arguments)
    words.push_back(word == settings.input.input ? frame.input : with_name(word, frame.name));
  const bool has_camera =
      std::ranges::any_of(std::array{"--camera", "--fov", "--vertical-fov", "--focal", "--aperture", "--ortho-width"},
                          [&](const char* option) { return is_typed(arguments, option); });
  if (!frame.camera.empty() && !has_camera) words.push_back("--camera=" + frame.camera);
  if (frame.radius && !is_typed(arguments, "--radius")) words.push_back(fmt::format("--radius={}", *frame.radius));
  return words;
}

/// Computes the frames of a list, each as by a command of its own. The first that fails ends it.
int run_list(const Words& arguments, const Settings& settings) {
  const auto frames = read_frame_list(settings.input.input, "INPUT");
  require_places(settings, frames);
  for (const auto& frame : frames)
    if (const int code = run_command(words_of_frame(arguments, settings, frame))) return code;
  return 0;
}

}  // namespace

int run_command(const std::vector<std::string>& arguments) {
  RunOptions options;
  if (!parse_run_options(arguments, options)) return 0;
  if (is_frame_list(options.settings.input.input)) return run_list(arguments, options.settings);
  FirstLook look(options.settings);
  if (!has_all(look, options.settings, arguments)) return int(ErrorKind::usage);
  if (options.dry_run) {
    fmt::print("{}", plan_text(look));
    return 0;
  }
  catch_ending_signals();
  Progress progress(options.settings.progress, options.settings.output.log_json);
  std::optional<Error> failure;
  const RunReport report = run_frames(look, {[&](const RunReport& begun, int frames) { progress.begin(begun, frames); },
                                             [&](const RunReport& noted) { progress.note(noted); },
                                             [&](const FrameReport& frame) {
                                               progress.frame(frame);
                                               if (frame.error) failure = frame.error;
                                             },
                                             [] { return caught_signal() != 0; },
                                             [&](std::span<const FrameProgress> frames) { progress.working(frames); }});
  progress.end(report);
  if (report.stop && !report.is_sequence) throw *report.stop;
  // Of a sequence each failure was told of with its frame.
  if (failure && !report.is_sequence) print_error("alcove: error: {}\n", printable(failure->what()));
  if (report.stop && report.failed == 0) print_error("alcove: error: {}\n", printable(report.stop->what()));
  if (report.stop) return int(report.stop->kind());
  if (caught_signal()) return 128 + caught_signal();
  return report.failed ? int(ErrorKind::some_frames_failed) : 0;
}

}  // namespace alcove
