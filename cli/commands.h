// The subcommands: purpose, options and work of each; arguments to the rows of a table, by the only door to CLI11; and
// messages to the standard error.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/options/option_row.h"

namespace alcove {

// Arguments.

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

/// Whether a word names an input: a file that is there, a name that ends as pictures do, or a pattern of such names.
bool names_input(const std::string& word);

/// Removes reports of an earlier command: where this one comes to no end, they would be taken for its own. "" is none.
void remove_earlier(const std::vector<std::string>& reports);

// Commands.

/// Ignores failures, since a log on a full disk should end no run.
template <class... Args>
void print_error(fmt::format_string<Args...> format, Args&&... args) {
  (void)std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

/// The name with the version; how it was built; with which libraries: a line each.
std::string version_text();

struct Subcommand {
  std::string name, sentence;
  int (*run)(const std::vector<std::string>& arguments);  // without program and subcommand; gives the exit code
  Command (*describe)();                                  // for help, man pages and completions
};

/// All of them, in the order of the help.
const std::vector<Subcommand>& subcommands();

/// `alcove --generate WHAT`, which the build asks for: WHAT is `man`, with the name of a command behind it or without,
/// `bash`, `zsh` or `fish`; or, for the completions, `preset-names` or `device-names`, a line each. Gives the exit
/// code. Fails with ErrorKind::usage.
int generate(const std::vector<std::string>& arguments);

int run_command(const std::vector<std::string>& arguments);
int inspect_command(const std::vector<std::string>& arguments);
int wedge_command(const std::vector<std::string>& arguments);
int compare_command(const std::vector<std::string>& arguments);
int bench_command(const std::vector<std::string>& arguments);
int presets_command(const std::vector<std::string>& arguments);
int devices_command(const std::vector<std::string>& arguments);
int doctor_command(const std::vector<std::string>& arguments);

Command describe_run();
Command describe_inspect();
Command describe_wedge();
Command describe_compare();
Command describe_bench();
Command describe_presets();
Command describe_devices();
Command describe_doctor();

}  // namespace alcove
