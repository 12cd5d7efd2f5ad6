// `alcove run`: options in, frames out, one line of summary.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/options.h"
#include "core/batch.h"

#include <fmt/format.h>

namespace alcove {

int run_command(const std::vector<std::string>& arguments) {
  RunOptions options;
  if (!parse_run_options(arguments, options)) return 0;
  const RunReport report = run_frames(options.settings);
  if (options.quiet) return 0;
  for (const auto& frame : report.frames) {
    for (const auto& note : frame.notes) fmt::print(stderr, "{}: {}\n", frame.input, note);
    if (options.verbose)
      for (const auto& pass : frame.passes) fmt::print(stderr, "{}: {} {:.3f} ms\n", frame.input, pass.name, pass.ms);
    fmt::print(stderr, "{} -> {}: read {:.0f} ms, compute {:.1f} ms on {}, write {:.0f} ms\n", frame.input, frame.output, frame.read_ms, frame.compute_ms,
               report.device, frame.write_ms);
  }
  return 0;
}

}  // namespace alcove
