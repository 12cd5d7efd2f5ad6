// Looks at a run's plan and at its first frame's headers.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/dry_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/text.h"
#include "core/frame/settle.h"
#include "core/options/check.h"
#include "core/run/first_look.h"
#include "core/run/frame_files.h"
#include "core/run/memory_plan.h"
#include "core/run/plan.h"
#include "core/run/resume.h"
#include "core/run/shot_memory.h"

namespace alcove {
namespace {

/// "shot.1001.exr" of one frame, "shot.1001.exr to shot.1100.exr" of several.
std::string span_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + " to " + last;
}

}  // namespace

std::string plan_text(const Settings& given) {
  check_settings(given);
  Notes notes;
  const Settings settings = with_proposed_radius(given, notes);
  const FramePlan plan(settings);
  add_new(notes, notes_on_names(plan, settings));
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += printable(fmt::format("{:<14}{}", name, value)) + "\n";
  };
  line("frames",
       plan.frames().empty() ? "none" : fmt::format("{}: {}", plan.frames().size(), frames_text(plan.frames())));
  if (!plan.missing().empty())
    line("missing", fmt::format("{}: {}, left out", plan.missing().size(), frames_text(plan.missing())));
  for (const auto& note : notes) line(level_of(note), line_of(note, ""));
  if (plan.frames().empty()) return text;
  Settings first = plan.at(plan.frames().front()), last = plan.at(plan.frames().back());
  require_endings(first.output);
  for (const auto& path : named_paths())
    if (!path.of(first).empty()) line(path.option, span_text(path.of(first), path.of(last)));

  FrameSource source = open_frame(first, plan.frames().front());
  // Frames of a sequence are read as one of them that shows enough.
  if (!plan.is_sequence()) settle_by_rows(source, first.input, memory_of_host(first.device).host_bytes);
  std::vector<std::string> channels;
  for (const auto& plane : source.planes.entries)
    for (const auto& channel : plane) channels.push_back(channel.channel);
  line("channels", fmt::format("{}", fmt::join(channels, ", ")));
  line("camera",
       fmt::format("{}, {:.6g} x {:.6g} px {}", source.camera.orthographic ? "orthographic" : "perspective",
                   source.camera.fx, source.camera.fy, source.camera.orthographic ? "per scene unit" : "focal length"));
  const FrameMemory frame = memory_with_others(plan, source, first);
  const std::uint64_t bytes = frame.of(source.file_data).host;
  const auto wanted = frames_to_compute(plan, settings);
  require_room_for_others(memory_of_host(first.device), plan, source, first, wanted);
  const RunMemory run = beside_shot(memory_of_host(first.device), plan, source, first, wanted, 1);
  const std::uint64_t memory = run.host_bytes;
  line("size", to_string(written_picture(source)));
  const std::string at_once =
      bytes > memory ? "in tiles" : fmt::format("up to {} at once", frames_in(run, frame, source.file_data));
  line("memory", fmt::format("{} MiB per frame, {} MiB for frames: {}", bytes >> 20, memory >> 20, at_once));
  if (around_of(first.input) > 0)
    line("around",
         fmt::format("up to {} of the {} frames of the shot: {} MiB of prepared frames for each at once, beside "
                     "what it takes itself",
                     most_others(plan, source, first.input), plan.shot().size(),
                     bytes_of_shot(plan, source, first.input, 1) >> 20));
  if (first.input.accumulate > 0)
    line("accumulate",
         fmt::format("up to {} of the {} frames of the shot: {} MiB of estimates for each at once, beside "
                     "what it takes itself",
                     std::min(plan.shot().size(), std::size_t(plan.turns())), plan.shot().size(),
                     bytes_of_estimates(plan, source, first, wanted, 1) >> 20));
  if (wanted.size() < plan.frames().size())
    line("kept", fmt::format("{}: whole, by an earlier run", plan.frames().size() - wanted.size()));
  return text;
}

}  // namespace alcove
