// `alcove run` as a command, and what its options print by themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/parsing.h"
#include "core/base/error.h"

namespace alcove {
namespace {

/// What presets and then the command line say; what is in no table (INPUT, and --json of inspect) is read at once.
std::vector<Said> all_said(const std::vector<Typed>& typed, const std::vector<OptionRow>& table) {
  std::vector<Said> said;
  const auto presets = std::ranges::find_if(typed, [](const Typed& one) { return one.row->name == "--preset"; });
  if (presets != typed.end())
    for (const auto& preset : presets_of(presets->words))
      std::ranges::copy(said_by_preset(preset, table), std::back_inserter(said));
  for (const auto& [row, words] : typed) {
    if (std::ranges::find(table, row->name, &OptionRow::name) != table.end())
      said.push_back({row->long_name(), words});
    else
      row->read(words);
  }
  return said;
}

constexpr const char* kRun =
    "Computes ambient occlusion from the depth and normals of a rendered frame.\n\n"
    "Examples:\n"
    "  alcove run frame.exr -o ao.exr --camera camera.json --radius 0.5\n"
    "  alcove run frame.%04d.exr -o ao.%04d.exr --frames 1001-1100 --camera camera.json --radius 0.5 --resume\n"
    "  alcove run frame.exr --beauty beauty.exr -o ao.exr --composite out.exr --fov 60 --radius 0.5 --preset "
    "production\n";

constexpr const char* kInspect =
    "Says what a frame's files hold, which channels would be used and how they would be understood, with the "
    "evidence,\nwhat is suspicious or missing, and the command that would run it. Of a sequence (shot.####.exr, with "
    "or "
    "without\n--frames) also what changes along it, by all headers and the pixels of a few frames. All options of "
    "alcove run are\ntaken; these say what would otherwise be guessed.\n\n"
    "Examples:\n"
    "  alcove inspect frame.exr\n"
    "  alcove inspect frame.exr --camera camera.json --preview sheet.png\n"
    "  alcove inspect frame.%04d.exr --json\n";

/// INPUT first, and then the table.
Command run_with(RunOptions& options, const std::vector<OptionRow>& table) {
  Command command{"alcove run", kRun, {}};
  OptionGroup(command.rows, "", Effect::input)
      .text("INPUT", options.settings.input.input, "",
            "an EXR file with depth and normals, or a pattern such as frame.%04d.exr")
      .is_key = false;
  command.rows.insert(command.rows.end(), table.begin(), table.end());
  return command;
}

/// Whether inspect looks at an option of run.
bool is_inspected(const OptionRow& row) {
  static const Words kOthers{"--frames", "--preset", "--radius", "--device", "--preview"};
  return row.group == "Input" || row.group == "Hidden surfaces" ||
         std::ranges::find(kOthers, row.name) != kOthers.end();
}

Command inspect_with(InspectOptions& options, const std::vector<OptionRow>& table) {
  Command command = run_with(options.run, table);
  command.name = "alcove inspect";
  command.description = kInspect;
  for (auto& row : command.rows) row.is_common = is_inspected(row);
  OptionGroup reports(command.rows, "Reports", Effect::none);
  reports.flag("--json", options.json, "print JSON").is_common = true;
  reports
      .text("--write-camera", options.write_camera, "FILE.json",
            "the camera that is found, for --camera; of a sequence with that of each frame")
      .is_common = true;
  return command;
}

/// Reads what the command line says; false where it asks for what is only printed.
bool read_arguments(const Command& command, const std::vector<std::string>& arguments,
                    const std::vector<OptionRow>& table, RunOptions& options, Reader reader) {
  const auto typed = find_typed(command, arguments);
  if (!typed) return false;
  try {
    read_said(options, all_said(*typed, table), reader);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) throw;
    fail(ErrorKind::usage, "{}{}", error.what(), see_help(command.name));
  }
  if (options.print_config) fmt::print("{}", preset_text(table));
  return !options.print_config;
}

Command run_for(RunOptions& options) { return run_with(options, option_table(options)); }

/// Only what inspect looks at.
Command inspect_for(InspectOptions& options) {
  Command command = inspect_with(options, option_table(options.run));
  std::erase_if(command.rows, [](const OptionRow& row) { return row.name.starts_with('-') && !row.is_common; });
  return command;
}

}  // namespace

Command describe_run() { return shown(run_for); }
Command describe_inspect() { return shown(inspect_for); }

bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options) {
  if (arguments == std::vector<std::string>{"--help-markdown"}) {
    fmt::print("{}", option_table_markdown());
    return false;
  }
  const auto table = option_table(options);
  return read_arguments(run_with(options, table), arguments, table, options, Reader::run);
}

bool parse_inspect_options(const std::vector<std::string>& arguments, InspectOptions& options) {
  const auto table = option_table(options.run);
  return read_arguments(inspect_with(options, table), arguments, table, options.run, Reader::inspect);
}

}  // namespace alcove
