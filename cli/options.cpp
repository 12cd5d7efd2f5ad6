// `alcove run` as a command, and what its options print by themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "cli/commands.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// What --set says, setting by setting; of one that repeats each is one more.
std::vector<Said> said_by_sets(const Words& sets, const std::vector<OptionRow>& table) {
  std::vector<Said> said;
  for (const auto& set : sets) {
    const std::size_t equals = std::min(set.find('='), set.size());
    if (equals == 0) fail(ErrorKind::usage, "--set: {} is not KEY=VALUE, such as denoise=none", alcove::said(set));
    const OptionRow& row = row_of_key(table, lower_case(set.substr(0, equals)));
    if (equals == set.size() && !row.is_flag())
      fail(ErrorKind::usage, "--set: {} is not KEY=VALUE: {} takes {}", set, row.key(), row.value);
    const std::string value = equals == set.size() ? "true" : set.substr(equals + 1);
    const auto earlier = std::ranges::find(said, row.long_name(), &Said::option);
    if (earlier == said.end())
      said.push_back({row.long_name(), {value}});
    else if (row.repeats)
      earlier->words.push_back(value);
    else
      fail(ErrorKind::usage, "{} is given more than once", row.long_name());
  }
  return said;
}

/// The words that were typed for an option; none: it was not.
Words words_for(const std::vector<Typed>& typed, const char* option) {
  const auto found = std::ranges::find_if(typed, [&](const Typed& one) { return one.row->name == option; });
  return found == typed.end() ? Words{} : found->words;
}

/// What presets and then the command line say; what is in no table (INPUT, and --json of inspect) is read at once.
std::vector<Said> all_said(const std::vector<Typed>& typed, const std::vector<OptionRow>& table) {
  std::vector<Said> said;
  for (const auto& preset : presets_of(words_for(typed, "--preset")))
    std::ranges::copy(said_by_preset(preset, table), std::back_inserter(said));
  for (auto& set : said_by_sets(words_for(typed, "--set"), table)) {
    const bool is_typed =
        std::ranges::any_of(typed, [&](const Typed& one) { return one.row->long_name() == set.option; });
    if (is_typed) fail(ErrorKind::usage, "{} is given more than once", set.option);
    said.push_back(std::move(set));
  }
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
  std::ranges::copy_if(table, std::back_inserter(command.rows), std::not_fn(&OptionRow::is_only_key));
  return command;
}

/// Whether inspect looks at an option of run.
bool is_inspected(const OptionRow& row) {
  static const Words kOthers{"--frames", "--preset", "--set", "--radius", "--device", "--preview"};
  return row.group == "Input" || row.group == "Hidden surfaces" ||
         std::ranges::find(kOthers, row.name) != kOthers.end();
}

Command inspect_with(InspectOptions& options, const std::vector<OptionRow>& table) {
  Command command = run_with(options.run, table);
  command.name = "alcove inspect";
  command.description = kInspect;
  for (auto& row : command.rows) {
    row.is_common = is_inspected(row);
    if (row.long_name() != "--verbose") continue;
    row.is_common = true;
    row.sentence = "also print attributes, statistics and the score of each reading";
  }
  OptionGroup reports(command.rows, "Reports", Effect::none);
  reports.flag("--json", options.json, "print JSON").is_common = true;
  reports
      .text("--write-camera", options.write_camera, "FILE.json",
            "the camera that is found, for --camera; of a sequence with that of each frame")
      .is_common = true;
  return command;
}

/// Refuses a key that is typed as an option, and says what to type.
void refuse_keys(const std::vector<std::string>& arguments, const std::vector<OptionRow>& table) {
  for (std::size_t i = 0; i < arguments.size(); i++) {
    const std::string& argument = arguments[i];
    const std::size_t equals = std::min(argument.find('='), argument.size());
    const auto row = std::ranges::find_if(table, [&](const OptionRow& one) {
      return one.is_only_key() && argument.substr(0, equals) == "--" + one.name;
    });
    if (row == table.end()) continue;
    const bool has_next = i + 1 < arguments.size() && !arguments[i + 1].starts_with("--");
    const std::string value = equals < argument.size() ? argument.substr(equals + 1)
                              : row->is_flag()         ? "true"
                              : has_next               ? arguments[i + 1]
                                                       : "VALUE";
    fail(ErrorKind::usage, "--{} is a setting: write --set {}", row->name, for_shell(row->name + "=" + value));
  }
}

/// Reads what the command line says; false where it asks for what is only printed.
bool read_arguments(const Command& command, const std::vector<std::string>& arguments,
                    const std::vector<OptionRow>& table, RunOptions& options, Reader reader) {
  refuse_keys(arguments, table);
  const auto typed = find_typed(command, arguments);
  if (!typed) return false;
  try {
    read_said(options, all_said(*typed, table), reader);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) throw;
    fail(ErrorKind::usage, "{}{}", error.what(), see_help(command.name));
  }
  if (options.print_config) fmt::print("{}", preset_text(table, options.settings));
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
