// `alcove run`: options in, frames out, one line of summary.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/formats/sequence.h"
#include "core/frame/raw_plane.h"
#include "core/run/batch.h"
#include "core/run/first_look.h"

namespace alcove {
namespace {

/// The name of an output beside which people look for it: ao.####.exr for shot.####.exr.
std::string usual_output(const std::string& input) {
  const auto pattern = frame_pattern(input);
  if (!pattern) return "ao.exr";
  const std::size_t token = pattern->before.size();
  return "ao." + input.substr(token, input.size() - token - pattern->after.size()) + ".exr";
}

/// Prints a line for each thing that is missing, and the command that has all of it. Returns whether nothing is.
bool has_all(const Settings& settings, const std::vector<std::string>& arguments) {
  const Lacking lacking = lacking_in(settings);
  if (!lacking.any()) return true;
  std::string command = "alcove run";
  if (lacking.input) command += " frame.exr";
  for (const auto& argument : arguments) command += " " + for_shell(argument);
  if (lacking.output) command += " -o " + for_shell(usual_output(main_input(settings.input)));
  if (lacking.camera) command += " --camera CAMERA.json";
  if (lacking.radius)
    command += " --radius " + (lacking.proposed_radius ? fmt::format("{}", *lacking.proposed_radius) : "auto");
  print_error("alcove: error: missing:\n");
  for (const auto& sentence : sentences_on(lacking)) print_error("  {}\n", printable(sentence));
  print_error("such as:\n{}\n", printable(command));
  return false;
}

}  // namespace

int run_command(const std::vector<std::string>& arguments) {
  RunOptions options;
  if (!parse_run_options(arguments, options)) return 0;
  if (!has_all(options.settings, arguments)) return int(ErrorKind::usage);
  if (options.dry_run) {
    fmt::print("{}", plan_text(options.settings));
    return 0;
  }
  catch_ending_signals();
  Progress progress(options.progress, options.settings.output.log_json);
  std::optional<Error> failure;
  const RunReport report =
      run_frames(options.settings, {[&](const RunReport& begun, int frames) { progress.begin(begun, frames); },
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
