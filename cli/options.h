// The options of `alcove run`, from presets and arguments; where presets lie.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/options/options.h"

namespace alcove {

/// Fills `options` from presets and arguments (argv without program and subcommand; later wins over earlier, arguments
/// over presets). Returns false where --help, --help-markdown or --print-config was asked for and printed. Fails with
/// ErrorKind::usage, naming the nearest options or presets.
bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options);

/// Gives the folder of presets: ALCOVE_PRESETS, else beside the program, above it, or in ../share/alcove. Fails with
/// ErrorKind::usage.
std::string preset_folder();
/// Gives the names of presets: paths below the folder without .toml, sorted.
std::vector<std::string> preset_names();
/// Gives the file of a preset, which is named or is a path. Fails with ErrorKind::usage, naming the nearest.
std::string preset_file(const std::string& name);

}  // namespace alcove
