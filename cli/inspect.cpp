// `alcove inspect INPUT [--json] [--preview FILE.png] [input options of run]`: what a frame holds and how it would be
// read.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/error.h"
#include "core/inspect/contact_sheet.h"
#include "core/inspect/inspect.h"
#include "core/run/plan.h"

namespace alcove {

int inspect_command(const std::vector<std::string>& arguments) {
  std::vector<std::string> rest = arguments;
  const bool json = std::erase(rest, "--json") > 0;
  if (std::ranges::any_of(rest, [](const auto& a) { return a == "--help" || a == "-h"; })) {
    fmt::print(
        "Usage: alcove inspect INPUT [--json] [--preview FILE.png] [input options]\n\nSays what the frame's files "
        "hold, which channels would be used and how they would "
        "be understood, with the evidence,\n"
        "what is suspicious or missing, and the command that would run it. --preview shows depth, normals and AO in a "
        "picture. Takes the input options of alcove run.\n");
    return 0;
  }
  RunOptions options;
  if (!parse_run_options(rest, options)) return 0;
  const InputSettings& input = options.settings.input;
  const std::string& path = !input.input.empty() ? input.input : input.depth.empty() ? input.position : input.depth;
  if (path.empty()) fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  const Inspection inspection = inspect_frame(input, frame_number_of(path));
  fmt::print("{}", json ? inspection_json(inspection) : inspection_text(inspection));
  if (inspection.unreadable) throw *inspection.unreadable;
  if (!options.settings.output.preview.empty()) write_contact_sheet(options.settings, frame_number_of(path));
  return 0;
}

}  // namespace alcove
