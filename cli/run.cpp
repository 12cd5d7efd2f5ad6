// `alcove run`: options in, frames out, one line of summary.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"
#include "cli/progress.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/run/batch.h"
#include "core/run/dry_run.h"

namespace alcove {

int run_command(const std::vector<std::string>& arguments) {
  RunOptions options;
  if (!parse_run_options(arguments, options)) return 0;
  if (options.dry_run) {
    fmt::print("{}", plan_text(options.settings));
    return 0;
  }
  catch_ending_signals();
  Progress progress(options.progress, options.settings.output.log_json);
  const RunReport report =
      run_frames(options.settings,
                 {[&](const RunReport& begun, int frames) { progress.begin(begun, frames); },
                  [&](const FrameReport& frame) { progress.frame(frame); }, [] { return caught_signal() != 0; }});
  progress.end(report);
  if (report.stop && !report.is_sequence) throw *report.stop;
  if (report.stop && report.failed == 0) print_error("alcove: error: {}\n", printable(report.stop->what()));
  if (report.stop) return int(report.stop->kind());
  if (caught_signal()) return 128 + caught_signal();
  return report.failed ? int(ErrorKind::some_frames_failed) : 0;
}

}  // namespace alcove
