// Which text is asked for; the texts are in man_pages.cpp and completions.cpp.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/generate.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/gpu/device_info.h"

namespace alcove {
namespace {

Command command_named(const std::string& name) {
  const auto found = std::ranges::find(subcommands(), name, &Subcommand::name);
  if (found == subcommands().end()) fail(ErrorKind::usage, "--generate man {}: there is no such command", name);
  return found->describe();
}

std::string text_of(const std::string& what) {
  if (what == "man") return man_page();
  if (what == "bash") return bash_completion();
  if (what == "zsh") return zsh_completion();
  if (what == "fish") return fish_completion();
  std::vector<std::string> names;
  if (what == "preset-names")
    names = preset_names();
  else if (what == "device-names")
    for (const auto& device : gpu::list_devices()) names.push_back(std::to_string(device.index));
  else
    fail(ErrorKind::usage, "--generate {}: there are man, bash, zsh, fish, preset-names and device-names", what);
  return fmt::format("{}\n", fmt::join(names, "\n"));
}

}  // namespace

int generate(const std::vector<std::string>& arguments) {
  const bool is_page = arguments.size() == 2 && arguments[0] == "man";
  if (arguments.size() != 1 && !is_page)
    fail(ErrorKind::usage, "--generate takes man [COMMAND], bash, zsh or fish, not {} words", arguments.size());
  fmt::print("{}", is_page ? man_page_of(command_named(arguments[1])) : text_of(arguments[0]));
  return 0;
}

std::vector<OptionRow> rows_with_help(const Command& command) {
  std::vector<OptionRow> rows;
  const auto is_place = [](const OptionRow& row) { return !row.name.starts_with('-'); };
  std::ranges::copy_if(command.rows, std::back_inserter(rows), is_place);
  rows.push_back({.group = "Help", .name = "-h,--help", .sentence = "print the help and stop"});
  if (has_common_rows(command))
    rows.push_back({.group = "Help", .name = "--help-all", .sentence = "print all options and stop"});
  std::ranges::copy_if(command.rows, std::back_inserter(rows), std::not_fn(is_place));
  return rows;
}

std::vector<std::string> names_of_row(const OptionRow& row) {
  const std::size_t comma = row.name.find(',');
  if (comma == row.name.npos) return {row.name};
  return {row.name.substr(0, comma), row.name.substr(comma + 1)};
}

}  // namespace alcove
