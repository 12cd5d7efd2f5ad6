// The options of `alcove run`, from presets and arguments; places and contents of presets.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/commands.h"
#include "core/inspect/inspect.h"
#include "core/options/options.h"

namespace alcove {

/// The command line of `alcove run`.
struct RunOptions {
  Settings settings;
  std::vector<OptionValue> values;  // of presets and of the command line, which make the settings
  bool dry_run = false;
  bool tells_presets = true;  // which files they are
};

/// Fills `options` from presets and arguments (argv without program and subcommand; later wins over earlier, arguments
/// over presets). Returns false where --help, --help-markdown or --print-config was asked for and printed. Fails with
/// ErrorKind::usage, naming the nearest options or presets, and on options that have no effect or contradict another.
bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options);

/// The options of `alcove run`: INPUT first, and then the table.
Command run_syntax();

/// Refuses a key that is typed as an option, and names the right spelling. Fails with ErrorKind::usage.
void refuse_keys(const std::vector<std::string>& arguments);

/// The usual name of an output, by the name of its input: ao.####.exr for shot.####.exr.
std::string usual_output(const std::string& input, const std::string& stem, const std::string& ending);

/// The command line of `alcove inspect`.
struct InspectOptions {
  RunOptions run;
  bool json = false;
  std::string write_camera;           // a file; empty: none
  std::vector<ProposedOption> typed;  // see CommandNames
};
/// Does the same for `alcove inspect`, which writes no outputs: there, no option can lack one.
bool parse_inspect_options(const std::vector<std::string>& arguments, InspectOptions& options);

/// Gives the folder of presets: ALCOVE_PRESETS, else beside the program, above it, or in ../share/alcove. Fails with
/// ErrorKind::usage.
std::string preset_folder();
/// Gives the names of presets, sorted: paths without .toml below that folder, below those of ALCOVE_PRESET_PATH and
/// below alcove/presets of the user's configuration.
std::vector<std::string> preset_names();
/// Gives the file of a preset, which is named, in any case, or is a path. ALCOVE_PRESET_PATH comes before the user's
/// configuration, and that before the program's own. Fails with ErrorKind::usage, naming the nearest.
std::string preset_file(const std::string& name);
/// Gives the presets of words that may be lists with commas: each word is a preset, or else its parts are.
std::vector<std::string> presets_of(const std::vector<std::string>& words);
/// Gives the alcove.toml beside a file or in the nearest folder above it. Fails with ErrorKind::usage.
std::string project_file(const std::string& input);
/// The values of a preset, after the values of the presets that it builds on, and the files in the same order.
struct PresetChain {
  std::vector<std::string> files;
  std::vector<OptionValue> values;  // files that they name are found: they lie beside the preset
};
/// Reads a preset. Fails with ErrorKind::usage, naming preset and key, on keys that are no options, and on presets that
/// build on themselves.
PresetChain read_chain(const std::string& name);

/// Fails with ErrorKind::usage where a relative name that an option gives would be taken for one of a sequence by the
/// name of the folder that it lies in.
void refuse_token_of_folder(const SettingRow& row, const std::string& word, const std::string& folder);

/// The purpose of a preset: the first sentence of the comment at the beginning of its file; "" without one.
std::string preset_sentence(const std::string& text);

}  // namespace alcove
