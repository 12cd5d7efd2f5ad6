// ONE table of options: it serves the command line, --help, the keys of presets, --print-config, docs/options.md,
// and the digest by which --resume knows its files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/options/row.h"

namespace alcove {

/// How a run reports its progress.
struct ProgressOptions {
  std::string kind = "auto";  // auto, bar, plain, percent, openjd or none; auto: a bar on a terminal, else plain
  bool verbose = false, quiet = false;
};

/// What the command line of `alcove run` says: the settings, and what only the command line itself needs.
struct RunOptions {
  Settings settings;
  Words presets;
  Words set;  // KEY=VALUE, as typed
  bool print_config = false;
  bool dry_run = false;
  ProgressOptions progress;
};

/// Gives the table, bound to `options`, whose present values are the defaults. `options` must outlive it.
std::vector<OptionRow> option_table(RunOptions& options);

/// Gives the row of a key of presets. Fails with ErrorKind::usage, naming the nearest, where there is none.
const OptionRow& row_of_key(const std::vector<OptionRow>& table, const std::string& key);

/// Gives unit and range of a number, as help shows them; "" where there is neither.
std::string range_text(const OptionRow& row);

/// Gives the table as docs/options.md shows it.
std::string option_table_markdown();

/// Gives the present values as a preset in TOML, one line per setting that has an effect.
std::string preset_text(const std::vector<OptionRow>& rows, const Settings& settings);

// The groups of the table, each in its own file.
void add_input_rows(std::vector<OptionRow>& rows, InputSettings& settings);
void add_hidden_rows(std::vector<OptionRow>& rows, Settings& settings);
void add_estimator_rows(std::vector<OptionRow>& rows, RunOptions& options);
void add_output_rows(std::vector<OptionRow>& rows, OutputSettings& settings);

}  // namespace alcove
