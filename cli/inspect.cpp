// `alcove inspect INPUT [--json] [-v] [--preview FILE.png] [--write-camera FILE.json] [input options of run]`: what a
// frame holds and how it would be read.
// SPDX-License-Identifier: BSD-3-Clause
#include <map>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/file.h"
#include "core/formats/sequence.h"
#include "core/frame/find/lights.h"
#include "core/frame/raw_plane.h"
#include "core/inspect/inspect.h"
#include "core/run/run_files.h"
#include "core/run/run_preview.h"

namespace alcove {

namespace {

/// Frames that are not there are no error here.
FramePlan plan_of(const Settings& settings) {
  Settings inputs = settings;
  inputs.output = {};
  inputs.frames.missing = Missing::skip;
  return FramePlan(inputs);
}

/// What the run is told that inspect proposes.
CommandNames names_of_run(const InspectOptions& asked, const FramePlan& plan) {
  const Settings& settings = asked.run.settings;
  const auto name = [&](const std::string& typed, const char* stem) {
    const std::string usual = usual_output(main_input(settings.input), stem, ".exr");
    if (!typed.empty()) return typed;
    return plan.is_sequence() && !frame_pattern(usual) ? fmt::format("{}.%04d.exr", stem) : usual;
  };
  return {settings.input, name(settings.output.output, "ao"), name(settings.output.composite, "composite"),
          settings.frames.frames, asked.typed};
}

/// Fails with ErrorKind::usage where nothing tells which camera of a list the frame has.
Inspection inspect_one(const FramePlan& plan, int frame, const CommandNames& run) {
  Notes notes;
  try {
    notes = notes_on_number(plan);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::usage) throw;
    // What is wrong with the camera file is a part of what is found.
  }
  const InputSettings& input = plan.settings().input;
  Inspection found = inspect_frame(input, frame, run);
  add_new(notes, found.notes);
  found.notes = std::move(notes);
  return found;
}

/// The camera of what was inspected, or of each frame that is there, as a file.
void write_cameras(const std::string& path, const FramePlan& plan, const InputSettings& input, int frame,
                   const Inspection& inspected) {
  if (!plan.is_sequence()) {
    const auto& known = inspected.camera;
    return write_whole(path, camera_file(known ? known->camera : find_frame(input, false, frame).reading.camera));
  }
  std::map<int, Camera> cameras;
  for (const int number : plan.frames())
    cameras[number] = find_frame(plan.at(number).input, false, number).reading.camera;
  write_whole(path, camera_file(cameras));
}

}  // namespace

int inspect_command(const std::vector<std::string>& arguments) {
  InspectOptions asked;
  if (!parse_inspect_options(arguments, asked)) return 0;
  const RunOptions& options = asked.run;
  const InputSettings& input = options.settings.input;
  const std::string& path = main_input(input);
  if (path.empty()) fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  const FramePlan plan = plan_of(options.settings);
  FileUses uses;
  add_inputs(uses, plan);
  for (const auto& file : files_of(options.settings, FileRole::input)) uses.add_input(file);
  for (const auto& [option, file] :
       {std::pair("--preview", options.settings.output.preview), {"--write-camera", asked.write_camera}})
    uses.add_output({option, file});
  // A beauty may be twice as wide as high, too: but it comes with depth, or with positions.
  const bool is_alone =
      path == input.input && input.depth.empty() && input.position.empty() && asked.write_camera.empty();
  if (is_alone && is_sky_picture(path)) {
    const Environment sky = read_environment(path, "INPUT");
    fmt::print("{}", asked.json ? environment_json(path, sky) : environment_text(path, sky));
    return 0;
  }
  const int frame = frame_number_of(path);
  const CommandNames run = names_of_run(asked, plan);
  const Inspection inspection = plan.is_sequence() ? inspect_sequence(plan, run) : inspect_one(plan, frame, run);
  fmt::print("{}",
             asked.json ? inspection_json(inspection) : inspection_text(inspection, options.settings.progress.verbose));
  if (inspection.unreadable) throw *inspection.unreadable;
  if (!asked.write_camera.empty()) write_cameras(asked.write_camera, plan, input, frame, inspection);
  if (options.settings.output.preview.empty()) return 0;
  Settings shown = options.settings;
  if (plan.is_sequence()) shown.input = plan.at(inspection.sequence->shown).input;
  write_contact_sheet(shown, plan.is_sequence() ? inspection.sequence->shown : frame);
  return 0;
}

}  // namespace alcove
