// ONE table of options: it serves the command line, --help, the keys of presets, --print-config and the README.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/progress.h"
#include "core/base/settings.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace alcove {

/// A row of the table.
struct OptionRow {
  std::string group, name;   // name: as typed, "--radius"
  std::string value;         // what stands behind it in help: FILE, NUMBER, the words to choose from; "" for a flag
  std::string unit, range;   // of a number; "" where there is none
  std::string sentence;      // ends without a full stop
  std::string default_text;  // "" where there is none
  std::function<CLI::Option*(CLI::App&)> add;  // binds the option to its setting
};

/// What `alcove run` takes besides its settings.
struct RunOptions {
  Settings settings;
  std::vector<std::string> presets;
  bool print_config = false;
  bool dry_run = false;
  ProgressOptions progress;
};

/// The table, bound to `options`, whose present values are the defaults. `options` must outlive it.
std::vector<OptionRow> option_table(RunOptions& options);

/// The table as README.md shows it; `alcove run --help-markdown` prints it.
std::string option_table_markdown();

/// Fills `options` from presets and arguments (argv without program and subcommand; later wins over earlier, arguments
/// over presets). False: --help, --help-markdown or --print-config was asked for and printed. Fails with
/// ErrorKind::usage, naming the nearest options or presets.
bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options);

/// The folder of presets: ALCOVE_PRESETS, else beside the program, above it, or in ../share/alcove. Fails with
/// ErrorKind::usage.
std::string preset_folder();
/// Names below the folder without .toml, sorted.
std::vector<std::string> preset_names();
/// The file of a preset, given by name or path. Fails with ErrorKind::usage, naming the nearest.
std::string preset_file(const std::string& name);

}  // namespace alcove
