// Looks at a run's plan and at its first frame's headers.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/dry_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/text.h"
#include "core/run/frame_files.h"
#include "core/run/memory_plan.h"
#include "core/run/plan.h"

namespace alcove {
namespace {

/// "shot.1001.exr" of one frame, "shot.1001.exr to shot.1100.exr" of several.
std::string span_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + " to " + last;
}

}  // namespace

std::string plan_text(const Settings& settings) {
  const FramePlan plan(settings);
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += printable(fmt::format("{:<14}{}", name, value)) + "\n";
  };
  line("frames",
       plan.frames().empty() ? "none" : fmt::format("{}: {}", plan.frames().size(), frames_text(plan.frames())));
  if (!plan.missing().empty())
    line("missing", fmt::format("{}: {}, left out", plan.missing().size(), frames_text(plan.missing())));
  if (plan.frames().empty()) return text;
  Settings first = plan.at(plan.frames().front()), last = plan.at(plan.frames().back());
  for (const auto& path : named_paths())
    if (!path.of(first).empty()) line(path.option, span_text(path.of(first), path.of(last)));

  const FrameSource source = open_frame(first, plan.frames().front());
  std::vector<std::string> channels;
  for (const auto& plane : source.planes.entries)
    for (const auto& channel : plane) channels.push_back(channel.channel);
  line("channels", fmt::format("{}", fmt::join(channels, ", ")));
  line("camera",
       fmt::format("{}, {:.6g} x {:.6g} px {}", source.camera.orthographic ? "orthographic" : "perspective",
                   source.camera.fx, source.camera.fy, source.camera.orthographic ? "per scene unit" : "focal length"));
  const std::uint64_t bytes = pixel_memory(source, first).bytes * source.file_data.pixels();
  const std::uint64_t memory = host_memory_for_frames(first.device);
  line("size", to_string(written_of(source)));
  const std::string at_once =
      bytes > memory ? "in tiles" : fmt::format("up to {} at once", memory / std::max<std::uint64_t>(1, bytes));
  line("memory", fmt::format("{} MiB per frame, {} MiB for frames: {}", bytes >> 20, memory >> 20, at_once));
  return text;
}

}  // namespace alcove
