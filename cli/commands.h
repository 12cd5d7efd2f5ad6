// The subcommands: each takes its arguments (without program and subcommand) and returns the exit code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace alcove {

int run_command(const std::vector<std::string>& arguments);
int inspect_command(const std::vector<std::string>& arguments);
int compare_command(const std::vector<std::string>& arguments);
int bench_command(const std::vector<std::string>& arguments);
int presets_command(const std::vector<std::string>& arguments);
int devices_command(const std::vector<std::string>& arguments);

}  // namespace alcove
