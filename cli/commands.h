// The subcommands: what each is for, what it takes, and what it does.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/parsing.h"

namespace alcove {

struct Subcommand {
  std::string name, sentence;
  int (*run)(const std::vector<std::string>& arguments);  // without program and subcommand; gives the exit code
  Command (*describe)();                                  // what help, man pages and completions show
};

/// All of them, in the order of the help.
const std::vector<Subcommand>& subcommands();

int run_command(const std::vector<std::string>& arguments);
int inspect_command(const std::vector<std::string>& arguments);
int compare_command(const std::vector<std::string>& arguments);
int bench_command(const std::vector<std::string>& arguments);
int presets_command(const std::vector<std::string>& arguments);
int devices_command(const std::vector<std::string>& arguments);
int doctor_command(const std::vector<std::string>& arguments);

Command describe_run();
Command describe_inspect();
Command describe_compare();
Command describe_bench();
Command describe_presets();
Command describe_devices();
Command describe_doctor();

}  // namespace alcove
