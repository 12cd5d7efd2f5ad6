// `alcove run` as a command, and what its options print by themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <fmt/format.h>

#include "cli/parsing.h"

namespace alcove {

bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options) {
  if (arguments == std::vector<std::string>{"--help-markdown"}) {
    fmt::print("{}", option_table_markdown());
    return false;
  }
  const std::vector<OptionRow> table = option_table(options);
  Command command{
      "alcove run",
      "Computes ambient occlusion from the depth and normals of a rendered frame.\n\n"
      "Examples:\n"
      "  alcove run frame.exr -o ao.exr --camera camera.json --radius 0.5\n"
      "  alcove run frame.%04d.exr -o ao.%04d.exr --frames 1001-1100 --camera camera.json --radius 0.5 --resume\n"
      "  alcove run frame.exr --beauty beauty.exr -o ao.exr --composite out.exr --fov 60 --radius 0.5 --preset "
      "production\n",
      {}};
  OptionGroup(command.rows, "", Effect::input)
      .text("INPUT", options.settings.input.input, "",
            "an EXR file with depth and normals, or a pattern such as frame.%04d.exr")
      .is_key = false;
  command.rows.insert(command.rows.end(), table.begin(), table.end());
  if (!parse_arguments(command, arguments)) return false;
  if (options.print_config) fmt::print("{}", preset_text(table));
  return !options.print_config;
}

}  // namespace alcove
