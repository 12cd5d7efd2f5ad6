// `alcove --generate WHAT`: man pages and completions, from the same rows as the help. The build asks for them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/parsing.h"

namespace alcove {

/// WHAT is `man`, with the name of a command behind it or without, `bash`, `zsh` or `fish`; or, for the completions,
/// `preset-names` or `device-names`, a line each. Gives the exit code. Fails with ErrorKind::usage.
int generate(const std::vector<std::string>& arguments);

/// A command's rows: its places, its help, and its options.
std::vector<OptionRow> rows_with_help(const Command& command);
/// The names of a row: "-o" and "--output".
std::vector<std::string> names_of_row(const OptionRow& row);

/// alcove(1) in roff.
std::string man_page();
/// The page of a command, such as alcove-run(1).
std::string man_page_of(const Command& command);

std::string bash_completion();
std::string zsh_completion();
std::string fish_completion();

}  // namespace alcove
