// Arguments to the rows of a table: the only door to CLI11.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/options/row.h"

namespace alcove {

/// A subcommand as its help shows it. Rows without a dash are arguments by place.
struct Command {
  std::string name;         // as typed, such as "alcove run"
  std::string description;  // with its examples
  std::vector<OptionRow> rows;
  std::shared_ptr<void> bound = {};  // what the rows bind, where nothing else keeps it
};

/// A command with arguments of its own, to be shown and not to be parsed.
template <class Arguments>
Command shown(Command (*make)(Arguments&)) {
  const auto arguments = std::make_shared<Arguments>();
  Command command = make(*arguments);
  command.bound = arguments;
  return command;
}

/// The words that were typed for a row.
struct Typed {
  const OptionRow* row;
  Words words;
};

/// Finds the words of each row that was typed, in the order of the rows; none where --help or --help-all was asked for
/// and printed. Fails with ErrorKind::usage in one sentence, with the nearest of the command's options where one is
/// misspelt.
std::optional<std::vector<Typed>> find_typed(const Command& command, const std::vector<std::string>& arguments);

/// Reads the arguments into what the rows bind. Returns false where help was asked for and printed. Fails with
/// ErrorKind::usage, also on values that the rows refuse.
bool parse_arguments(const Command& command, const std::vector<std::string>& arguments);

/// Whether help shows only some rows of the command, and --help-all all of them.
bool has_common_rows(const Command& command);

/// Behind a message: where the options of the command stand.
std::string see_help(const std::string& command);

/// Whether a word names an input: a file that is there, a name that ends as pictures do, or a pattern of such names.
bool names_input(const std::string& word);

}  // namespace alcove
