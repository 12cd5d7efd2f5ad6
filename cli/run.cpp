// `alcove run`: options in, frames out, one line of summary.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "core/base/file.h"
#include "core/base/frame_list.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/frame/raw_plane.h"
#include "core/options/options.h"
#include "core/run/batch.h"
#include "core/run/run_files.h"
#include "core/run/run_preview.h"

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
/// `of_frame` begins messages on a frame of a list.
bool has_all(RunPreview& look, const Settings& settings, const Words& arguments, const std::string& of_frame) {
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
  print_error("alcove: error: {}missing:\n", printable(of_frame));
  for (const auto& sentence : missing.sentences()) print_error("  {}\n", printable(sentence));
  print_error("such as:\n{}\n", printable(command));
  return false;
}

/// Whether the command line gives a setting of these keys.
bool is_typed(const RunOptions& options, const Words& keys) {
  return std::ranges::any_of(options.values, [&](const OptionValue& value) {
    return value.is_typed() && std::ranges::find(keys, value.row->key()) != keys.end();
  });
}

/// The camera file, and all that say otherwise what the camera sees.
Words camera_keys() {
  Words keys{"camera"};
  const auto others = std::ranges::find(rivals(), keys, &Rivals::one);
  keys.insert(keys.end(), others->other.begin(), others->other.end());
  return keys;
}

/// The options for a frame of a list: its file, and its camera and radius unless others are typed.
RunOptions options_of(const RunOptions& options, const ListedFrame& frame) {
  RunOptions own = options;
  for (auto& value : own.values)
    for (auto& word : value.words) word = with_name(word, frame.name);
  if (!frame.camera.empty() && !is_typed(options, camera_keys()))
    own.values.push_back({&row_of_key("camera"), {frame.camera}});
  if (frame.radius && !is_typed(options, {"radius"}))
    own.values.push_back({&row_of_key("radius"), {fmt::format("{}", *frame.radius)}});
  Settings initial;
  initial.input.input = frame.input;
  own.settings = with_values(initial, own.values);
  own.settings.preset_files = options.settings.preset_files;
  return own;
}

/// Whether a sentence names an option, and not just one whose name begins alike.
bool names_option(const std::string& sentence, const std::string& option) {
  for (std::size_t at = sentence.find(option); at != sentence.npos; at = sentence.find(option, at + 1)) {
    const std::size_t end = at + option.size();
    if (end == sentence.size() || (!std::isalnum((unsigned char)sentence[end]) && sentence[end] != '-')) return true;
  }
  return false;
}

/// Adds the presets that give the options which a sentence names.
std::string with_presets(const std::string& sentence, const Settings& settings) {
  std::string text = sentence;
  for (const auto& [option, preset] : settings.input.from_presets)
    if (names_option(sentence, option)) text += fmt::format("; {} is of {}", option, preset);
  return text;
}

/// Computes the frames of one input. Gives the exit code.
int run_input(const RunOptions& options, const Words& arguments, const std::string& of_frame) {
  RunPreview look(options.settings);
  if (!has_all(look, options.settings, arguments, of_frame)) return int(ErrorKind::usage);
  if (options.dry_run) {
    fmt::print("{}", plan_text(look));
    return 0;
  }
  catch_ending_signals();
  Progress progress(options.settings.progress, options.settings.output.log_json, options.tells_presets);
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
  if (failure && !report.is_sequence)
    print_error("alcove: error: {}{}\n", printable(of_frame),
                printable(with_presets(failure->what(), options.settings)));
  if (report.stop && report.failed == 0)
    print_error("alcove: error: {}{}\n", printable(of_frame), printable(report.stop->what()));
  if (report.stop) return int(report.stop->kind());
  if (caught_signal()) return 128 + caught_signal();
  return report.failed ? int(ErrorKind::some_frames_failed) : 0;
}

/// The same, with the frame and the presets in the sentence of an Error.
int run_named(const RunOptions& options, const Words& arguments, const std::string& of_frame = "") {
  try {
    return run_input(options, arguments, of_frame);
  } catch (const Error& error) {
    fail(error.kind(), "{}{}", of_frame, with_presets(error.what(), options.settings));
  }
}

/// A frame of a list with all that its run takes.
struct ListedRun {
  std::string name;
  RunOptions options;
};

/// Fails where a frame's output has no place for its name, where two frames would write one file, and where one would
/// write what another reads.
void require_places(const Settings& settings, const std::vector<ListedRun>& runs) {
  for (const FileRole role : {FileRole::output, FileRole::report})
    for (const auto& file : files_of(settings, role))
      if (file.path.find(kNamePlace) == file.path.npos)
        fail(ErrorKind::usage, "{} {}: {}", file.option, file.path, why_no_place(settings.input.input));
  FileUses uses;
  uses.add_input({"INPUT", settings.input.input});
  std::vector<std::pair<std::string, FramePlan>> plans;
  for (const auto& run : runs) try {
      add_inputs(uses, plans.emplace_back(run.name, FramePlan(run.options.settings)).second);
    } catch (const Error& error) {  // a missing input is told of later
      if (error.kind() != ErrorKind::input) throw;
    }
  for (const auto& [name, plan] : plans) add_outputs(uses, plan, " of frame " + name);
}

/// Fails where an input of a frame is not there.
void require_inputs(const ListedRun& run) {
  const FramePlan plan(run.options.settings);
  for (const int frame : plan.frames())
    for (const auto& file : files_of(plan.at(frame), FileRole::input))
      require_readable(file.path, ("frame " + run.name + "'s").c_str(), file.option.c_str());
}

/// Whether a frame's own INPUT is there, or one of a pattern.
bool has_input(const ListedRun& run) {
  const std::string& input = run.options.settings.input.input;
  std::error_code none;
  if (std::filesystem::exists(input, none)) return true;
  const auto pattern = frame_pattern(input);
  try {
    return pattern && !frames_on_disk(*pattern, "INPUT").empty();
  } catch (const Error&) {  // not even a folder
    return false;
  }
}

/// Leaves out frames of which an input is missing, and tells whether one has failed by it. That is an error before any
/// work, or with --keep-going a frame that fails. Only a frame's own INPUT may be missing, where the settings say so.
bool leave_out_missing(std::vector<ListedRun>& runs, const FrameSettings& frames) {
  bool has_failed = false;
  const auto leaves_out = [&](const ListedRun& run) {
    try {
      require_inputs(run);
      return false;
    } catch (const Error& error) {
      const bool may_be_missing = frames.missing == Missing::skip && !has_input(run);
      if (error.kind() != ErrorKind::input || !(may_be_missing || frames.keep_going)) throw;
      print_error("alcove: {}frame {} is left out: {}\n", may_be_missing ? "" : "error: ", printable(run.name),
                  printable(error.what()));
      has_failed |= !may_be_missing;
      return true;
    }
  };
  std::erase_if(runs, leaves_out);
  return has_failed;
}

/// Whether an exit code is of one frame alone, so that others may do.
bool is_of_frame(int code) { return code == int(ErrorKind::input) || code == int(ErrorKind::some_frames_failed); }

/// Computes a frame of a list as by a command of its own. Gives the exit code.
int run_listed(const ListedRun& run, const Words& arguments, bool keeps_going) {
  try {
    return run_named(run.options, arguments, "frame " + run.name + ": ");
  } catch (const Error& error) {
    if (!keeps_going || !is_of_frame(int(error.kind()))) throw;
    print_error("alcove: error: {}\n", printable(error.what()));
    return int(error.kind());
  }
}

/// Computes the frames of a list. The first that fails ends it, unless the settings say to go on; what is wrong with
/// settings, outputs or the device ends it always.
int run_list(const RunOptions& options, const Words& arguments) {
  const FrameSettings& frames = options.settings.frames;
  std::vector<ListedRun> runs;
  for (const auto& frame : read_frame_list(options.settings.input.input, "INPUT"))
    runs.push_back({frame.name, options_of(options, frame)});
  require_places(options.settings, runs);
  bool has_failed = leave_out_missing(runs, frames);
  if (runs.empty() && !has_failed)
    fail(ErrorKind::input, "{}: the input of each frame is missing", options.settings.input.input);
  for (auto& run : runs) {
    run.options.tells_presets = &run == &runs.front();
    const int code = run_listed(run, arguments, frames.keep_going);
    if (code && (!frames.keep_going || caught_signal() || !is_of_frame(code))) return code;
    has_failed |= code != 0;
  }
  return has_failed ? int(ErrorKind::some_frames_failed) : 0;
}

}  // namespace

int run_command(const std::vector<std::string>& arguments) {
  RunOptions options;
  if (!parse_run_options(arguments, options)) return 0;
  return is_frame_list(options.settings.input.input) ? run_list(options, arguments) : run_named(options, arguments);
}

}  // namespace alcove
