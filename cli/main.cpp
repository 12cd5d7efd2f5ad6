// Picks the subcommand, catches errors once, returns the exit code.
// SPDX-License-Identifier: BSD-3-Clause
#include <new>

#include "cli/commands.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/base/version.h"

using namespace alcove;

namespace {

void print_help() {
  fmt::print(
      "alcove {}: ambient occlusion from rendered depth and normals\n\nUsage: alcove COMMAND [options]\n"
      "       alcove FILE.exr [options]\n\n",
      kVersion);
  for (const auto& command : subcommands()) fmt::print("  {:<10}{}\n", command.name, command.sentence);
  fmt::print("\nWithout a command an input is run. alcove help COMMAND, or alcove COMMAND --help, tells the rest.\n");
}

/// The command of that name. Fails with the nearest names where there is none.
const Subcommand& command_of(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& command : subcommands()) {
    if (name == command.name) return command;
    names.push_back(command.name);
  }
  names.emplace_back("help");
  fail(ErrorKind::usage, "there is no command {}{}; there is {}, and alcove FILE.exr is alcove run", name,
       suggestion(name, names), list_of(names));
}

/// `alcove help [COMMAND]`.
int help(const std::vector<std::string>& arguments) {
  if (arguments.size() > 1) fail(ErrorKind::usage, "alcove help takes one command, not {} words", arguments.size());
  if (arguments.empty()) print_help();
  return arguments.empty() ? 0 : command_of(arguments[0]).run({"--help"});
}

/// Runs the command that the first argument names, or else `alcove run`. Gives the exit code.
int dispatch(const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "--help-all") {
    print_help();
    return arguments.empty() ? int(ErrorKind::usage) : 0;
  }
  const std::string& first = arguments[0];
  if (first == "--version") {
    fmt::print("{}", version_text());
    return 0;
  }
  if (first == "--generate") return generate({arguments.begin() + 1, arguments.end()});
  if (first == "help") return help({arguments.begin() + 1, arguments.end()});
  const auto& commands = subcommands();
  const bool is_known = std::ranges::find(commands, first, &Subcommand::name) != commands.end();
  const bool is_run = names_input(first) || (first.starts_with('-') && std::ranges::any_of(arguments, names_input));
  if (!is_known && is_run) return run_command(arguments);
  if (first.starts_with('-'))
    fail(ErrorKind::usage, "{}: name a command before it, such as run, or an input; see alcove --help", first);
  return command_of(first).run({arguments.begin() + 1, arguments.end()});
}

}  // namespace

int main(int argc, char** argv) {
  prepare_streams();
  try {
    const int code = dispatch({argv + 1, argv + argc});
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      fail(ErrorKind::output, "the standard output cannot be written");
    return code;
  } catch (const Error& error) {
    print_error("alcove: error: {}\n", printable(error.what()));
    return int(error.kind());
  } catch (const std::bad_alloc&) {
    print_error(
        "alcove: error: no memory is left: let a run take less by --memory, and other commands have smaller "
        "pictures\n");
    return int(ErrorKind::device);
  } catch (const std::exception& error) {
    const bool is_output = std::ferror(stdout) != 0;  // which fmt tells by an exception of its own
    print_error("alcove: error: {}{}\n", is_output ? "the standard output: " : "unexpected: ", printable(error.what()));
    if (is_output) return int(ErrorKind::output);
    return int(ErrorKind::some_frames_failed);
  }
}
