// Picks the subcommand, catches errors once, returns the exit code.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/generate.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace {

void print_help() {
  fmt::print(
      "alcove {}: ambient occlusion from rendered depth and normals\n\nUsage: alcove COMMAND [options]\n"
      "       alcove FILE.exr [options]\n\n",
      alcove::kVersion);
  for (const auto& command : alcove::subcommands()) fmt::print("  {:<10}{}\n", command.name, command.sentence);
  fmt::print("\nWithout a command an input is run. alcove help COMMAND, or alcove COMMAND --help, tells the rest.\n");
}

/// The command of that name. Fails with the nearest names where there is none.
const alcove::Subcommand& command_of(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& command : alcove::subcommands()) {
    if (name == command.name) return command;
    names.push_back(command.name);
  }
  names.emplace_back("help");
  alcove::fail(alcove::ErrorKind::usage, "there is no command {}{}; there is {}, and alcove FILE.exr is alcove run",
               name, alcove::suggestion(name, names), alcove::list_of(names));
}

/// `alcove help [COMMAND]`.
int help(const std::vector<std::string>& arguments) {
  if (arguments.size() > 1)
    alcove::fail(alcove::ErrorKind::usage, "alcove help takes one command, not {} words", arguments.size());
  if (arguments.empty()) print_help();
  return arguments.empty() ? 0 : command_of(arguments[0]).run({"--help"});
}

int dispatch(const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "--help-all") {
    print_help();
    return arguments.empty() ? int(alcove::ErrorKind::usage) : 0;
  }
  const std::string& first = arguments[0];
  if (first == "--version") {
    fmt::print("{}", alcove::version_text());
    return 0;
  }
  if (first == "--generate") return alcove::generate({arguments.begin() + 1, arguments.end()});
  if (first == "help") return help({arguments.begin() + 1, arguments.end()});
  const auto& commands = alcove::subcommands();
  const bool is_known = std::ranges::find(commands, first, &alcove::Subcommand::name) != commands.end();
  const bool is_run =
      alcove::names_input(first) || (first.starts_with('-') && std::ranges::any_of(arguments, alcove::names_input));
  if (!is_known && is_run) return alcove::run_command(arguments);
  if (first.starts_with('-'))
    alcove::fail(alcove::ErrorKind::usage, "{}: name a command before it, such as run, or an input; see alcove --help",
                 first);
  return command_of(first).run({arguments.begin() + 1, arguments.end()});
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int code = dispatch({argv + 1, argv + argc});
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      alcove::fail(alcove::ErrorKind::output, "the standard output cannot be written");
    return code;
  } catch (const alcove::Error& error) {
    alcove::print_error("alcove: error: {}\n", alcove::printable(error.what()));
    return int(error.kind());
  } catch (const std::bad_alloc&) {
    alcove::print_error(
        "alcove: error: no memory is left: let a run take less by --memory, and other commands have smaller "
        "pictures\n");
    return int(alcove::ErrorKind::device);
  } catch (const std::exception& error) {
    const bool is_output = std::ferror(stdout) != 0;  // which fmt tells by an exception of its own
    alcove::print_error("alcove: error: {}{}\n",
                        is_output ? "the standard output: " : "unexpected: ", alcove::printable(error.what()));
    if (is_output) return int(alcove::ErrorKind::output);
    return int(alcove::ErrorKind::some_frames_failed);
  }
}
