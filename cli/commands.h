// The subcommands: purpose, options and work of each; and messages to the standard error.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "cli/parsing.h"

namespace alcove {

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
/// `bash`, `zsh` or `fish`; or, for the completions, `preset-names` or `device-names`, a line each. Gives the exit code.
/// Fails with ErrorKind::usage.
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
