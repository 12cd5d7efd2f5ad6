// `alcove presets [NAME]`: lists the presets, or prints one.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {

int presets_command(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && (arguments[0] == "--help" || arguments[0] == "-h")) {
    fmt::print("Usage: alcove presets [NAME]\n\nLists the presets of {}, or prints the one of that name.\n",
               preset_folder());
    return 0;
  }
  if (arguments.size() > 1)
    fail(ErrorKind::usage, "alcove presets takes at most one name, not {} arguments", arguments.size());
  if (arguments.size() == 1) {
    fmt::print("{}", read_text(preset_file(arguments[0]), "preset", "NAME"));
    return 0;
  }
  for (const auto& name : preset_names()) fmt::print("{}\n", printable(name));
  return 0;
}

}  // namespace alcove
