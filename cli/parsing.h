// Arguments to the rows of a table: the only door to CLI11.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/options/option_row.h"

namespace alcove {

/// A subcommand as its help shows it. Rows without a dash are arguments by place.
struct Command {
  std::string name;         // as typed, such as "alcove run"
  std::string description;  // with its examples
  std::vector<OptionRow> rows;
};

/// An option that was typed, by the name of its row, with its words.
struct TypedOption {
  std::string name;
  Words words;
};

/// Finds the options that were typed, in the order of the rows; nothing where --help or --help-all was asked for and
/// printed. Fails with ErrorKind::usage in one sentence, with the nearest of the command's options where one is
/// misspelt.
std::optional<std::vector<TypedOption>> typed_options(const Command& command,
                                                      const std::vector<std::string>& arguments);

/// Calls it, and points to the help of the command in the sentence of an Error of kind usage.
void with_help(const Command& command, const std::function<void()>& call);

/// A subcommand whose options are the parts of an `Arguments`.
template <class Arguments>
struct CommandOf {
  std::string name, description;  // as those of Command
  std::vector<RowOf<Arguments>> rows = {};

  Command shown() const { return {name, description, {rows.begin(), rows.end()}}; }
  /// Gives the typed words; nothing if help was asked for and printed. Fails with ErrorKind::usage, also on values that
  /// the rows refuse.
  std::optional<Arguments> parse(const std::vector<std::string>& arguments) const {
    const Command command = shown();
    const auto typed = typed_options(command, arguments);
    if (!typed) return std::nullopt;
    Arguments parsed;
    with_help(command, [&] {
      for (const auto& option : *typed)
        std::ranges::find(rows, option.name, &OptionRow::name)->read(parsed, option.words);
    });
    return parsed;
  }
};

/// Whether help shows only some rows of the command, and --help-all all of them.
bool has_common_rows(const Command& command);

/// Behind a message: where the options of the command stand.
std::string see_help(const std::string& command);

/// Whether a word names an input: a file that is there, a name that ends as pictures do, or a pattern of such names.
bool names_input(const std::string& word);

/// Removes reports of an earlier command: where this one comes to no end, they would be taken for its own. "" is none.
void remove_earlier(const std::vector<std::string>& reports);

}  // namespace alcove
