// Arguments to the rows of a table: the only door to CLI11.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/options/row.h"

namespace alcove {

/// A subcommand as its help shows it. Rows without a dash are arguments by place.
struct Command {
  std::string name;         // as typed, such as "alcove run"
  std::string description;  // with its examples
  std::vector<OptionRow> rows;
};

/// Reads the arguments into what the rows bind: presets first, where the command has --preset, then the arguments.
/// Returns false where --help was asked for and printed. Fails with ErrorKind::usage in one sentence, with the nearest
/// of the command's options where one is misspelt, and with the name of the preset where one is wrong.
bool parse_arguments(const Command& command, const std::vector<std::string>& arguments);

}  // namespace alcove
