// `alcove run` as a command, and what its options print by themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/parsing.h"
#include "core/base/error.h"

namespace alcove {
namespace {

/// What presets and then the command line say; INPUT, which is in no table, is read at once.
std::vector<Said> all_said(const std::vector<Typed>& typed, const std::vector<OptionRow>& table) {
  std::vector<Said> said;
  const auto presets = std::ranges::find_if(typed, [](const Typed& one) { return one.row->name == "--preset"; });
  if (presets != typed.end())
    for (const auto& preset : presets_of(presets->words))
      std::ranges::copy(said_by_preset(preset, table), std::back_inserter(said));
  for (const auto& [row, words] : typed) {
    if (row->name.starts_with('-'))
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
    "Says what a frame holds; these options of alcove run say what it would otherwise guess.\n";

Command command_for(Reader reader, RunOptions& options, const std::vector<OptionRow>& table) {
  Command command = reader == Reader::run ? Command{"alcove run", kRun, {}} : Command{"alcove inspect", kInspect, {}};
  OptionGroup(command.rows, "", Effect::input)
      .text("INPUT", options.settings.input.input, "",
            "an EXR file with depth and normals, or a pattern such as frame.%04d.exr")
      .is_key = false;
  command.rows.insert(command.rows.end(), table.begin(), table.end());
  return command;
}

}  // namespace

bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options, Reader reader) {
  if (arguments == std::vector<std::string>{"--help-markdown"}) {
    fmt::print("{}", option_table_markdown());
    return false;
  }
  const std::vector<OptionRow> table = option_table(options);
  const Command command = command_for(reader, options, table);
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

}  // namespace alcove
