// Adds up buffers and prepared frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/shot_memory.h"

#include <algorithm>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/system.h"
#include "core/chain/aov.h"
#include "core/frame/views.h"
#include "core/run/shot.h"
#include "kernels/moved.h"

namespace alcove {
namespace {

constexpr std::size_t kPlanesOfSeen = 3;    // depth, normals, what moves
constexpr std::size_t kPlanesPrepared = 5;  // that passes make of it: depth, normals, flags, what moves, surfels

/// Planes of values of an estimate: see EstimateSet.
std::size_t values_of(const Settings& settings) {
  const std::size_t further = settings.estimator.further_radii.size();
  return 1 + (further > 0 ? 1 + further : 0) + (needs_bent(settings.estimator, settings.output) ? 3 : 0);
}

/// The most estimates that so many lanes keep at once: those that the frames take which they compute, and the next one.
std::uint64_t most_estimates(const FramePlan& plan, std::span<const int> frames, std::size_t lanes) {
  std::unordered_map<int, int> takers;
  std::size_t most = 0;
  for (std::size_t i = 0; i < frames.size(); i++) {
    for (const int taken : plan.accumulated(frames[i]).there) takers[taken]++;
    most = std::max(most, takers.size());
    if (i < lanes) continue;
    for (const int taken : plan.accumulated(frames[i - lanes]).there)
      if (--takers[taken] == 0) takers.erase(taken);
  }
  return most;
}

/// The buffers in which a frame takes the mean of many, and those of what it takes.
std::uint64_t bytes_of_mean(const FramePlan& plan, const FrameSource& frame, const Settings& settings) {
  if (settings.input.accumulate == 0) return 0;
  const std::size_t values = values_of(settings);
  const std::size_t taken = std::min(plan.shot().size(), std::size_t(plan.turns())) * (2 + values / 2);
  // Suspects are a word for four pixels.
  const std::size_t own = 2 + values, sums = 1 + 2 * values, suspects = 1;
  return sizeof(float) * (frame.file_data.pixels() * (taken + own + sums + suspects) + kMovedCells);
}

/// What it takes to read the motion vectors of a frame, and to mark what moves: up to two pairs of planes.
std::uint64_t bytes_of_motion(const FrameSource& frame, const InputSettings& settings) {
  if (settings.motion.empty() || !takes_frames(settings)) return 0;
  const std::size_t planes = settings.motion_channels.find(',') == std::string::npos ? 4 : 2;
  return frame.file_data.pixels() * (planes * sizeof(float) + sizeof(std::uint8_t));
}

/// What one frame at a time takes with all around it: as a whole, or at least, in the smallest of tiles.
std::uint64_t bytes_of_one(const FramePlan& plan, const FrameSource& frame, const Settings& settings,
                           std::span<const int> frames, bool is_whole) {
  const FrameMemory memory = memory_with_others(plan, frame, settings);
  return bytes_of_shot(plan, frame, settings.input, 1) + bytes_of_estimates(plan, frame, settings, frames, 1) +
         (is_whole ? memory.of(frame.file_data).host : memory.fixed_on_device + memory.fixed_bytes);
}

/// Fails as require_buffers_for_others() does, with the estimates that frames take of each other.
void require_buffers_for_estimates(std::uint64_t most_bytes, const FrameSource& frame, const Settings& settings) {
  if (settings.input.accumulate == 0) return;
  const std::size_t values = values_of(settings), planes = std::max(values, 2 + values / 2);
  const std::uint64_t bytes = sizeof(float) * planes * frame.file_data.pixels();
  if (bytes <= most_bytes) return;
  fail(ErrorKind::device,
       "{}: --accumulate takes the estimates of frames whole, in a buffer of {} MiB, where the device has {} MiB at "
       "most: leave it out, {}or use another --device",
       frame.depth_path(), bytes / kMebibyte, most_bytes / kMebibyte,
       values > 1 ? "ask for one --radius and no directions, " : "");
}

}  // namespace

std::size_t most_others(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings) {
  const std::size_t around =
      around_of(settings) == 0 ? 0 : std::min(plan.shot().size(), 2 * std::size_t(around_of(settings)));
  return around + (settings.other_views ? views_of(frame.files[frame[RawPlane::depth][0].file]).size() : 0);
}

FrameMemory memory_with_others(const FramePlan& plan, const FrameSource& frame, const Settings& settings) {
  FrameMemory memory = memory_of(frame, settings);
  memory.fixed_on_device = bytes_of_mean(plan, frame, settings);
  memory.fixed_bytes += bytes_of_motion(frame, settings.input);
  const std::size_t others = most_others(plan, frame, settings.input);
  if (!takes_others(settings.input)) return memory;
  // What tells what moves in one of them takes those around it.
  const int count = around_of(settings.input);
  const std::size_t judges = count == 0 ? 0 : std::min(plan.shot().size(), std::size_t(most_judges(count)));
  const std::size_t buffers = others == 0 ? 0 : kPlanesOfSeen * std::max(others, judges + 1);
  const std::size_t prepared = frame[RawPlane::depth].size() + frame[RawPlane::normal].size() + kPlanesPrepared;
  memory.fixed_on_device += sizeof(float) * frame.file_data.pixels() * (buffers + prepared);
  return memory;
}

std::uint64_t bytes_of_shot(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings, int lanes) {
  if (!takes_frames(settings)) return 0;
  const std::uint64_t around = 2 * std::uint64_t(with_judges(around_of(settings))) + 1;
  // All frames of a mean look at others, and near the ends of the shot they all lie on one side. Frames that are
  // computed at once may lie far from each other.
  const std::uint64_t means = 2 * std::uint64_t(settings.accumulate);
  const std::uint64_t window = std::uint64_t(lanes) * (around + means) + means;
  return kPlanesOfSeen * sizeof(float) * frame.file_data.pixels() * std::min<std::uint64_t>(plan.shot().size(), window);
}

std::uint64_t bytes_of_estimates(const FramePlan& plan, const FrameSource& frame, const Settings& settings,
                                 std::span<const int> frames, int lanes) {
  if (settings.input.accumulate == 0) return 0;
  // What was read of one is kept with its estimate until it is computed itself, as at first none of them is.
  return (sizeof(float) * frame.file_data.pixels() * (2 + values_of(settings)) + raw_bytes_of(frame)) *
         most_estimates(plan, frames, std::size_t(lanes));
}

RunMemory beside_shot(const RunMemory& memory, const FramePlan& plan, const FrameSource& frame,
                      const Settings& settings, std::span<const int> frames, int lanes) {
  RunMemory left = memory;
  const std::uint64_t bytes = std::min(memory.host_bytes, bytes_of_shot(plan, frame, settings.input, lanes) +
                                                              bytes_of_estimates(plan, frame, settings, frames, lanes));
  left.host_bytes -= bytes;
  left.program_bytes += bytes;
  return left;
}

void require_room_for_others(const RunMemory& memory, const FramePlan& plan, const FrameSource& frame,
                             const Settings& settings, std::span<const int> frames) {
  const InputSettings& input = settings.input;
  if (around_of(input) == 0 && input.accumulate == 0) return;
  if (bytes_of_one(plan, frame, settings, frames, false) <= memory.host_bytes) return;
  Settings fewer = settings;
  fewer.input.around = int(std::min<std::size_t>(plan.shot().size(), std::size_t(around_of(input))));
  fewer.input.around_all = false;
  while (fewer.input.around > 0 && bytes_of_one(plan, frame, fewer, frames, true) > memory.host_bytes)
    fewer.input.around--;
  const std::string mend = input.accumulate > 0 ? fmt::format("a smaller --accumulate than {}", input.accumulate)
                                                : fmt::format("--around {}", fewer.input.around);
  fail(memory.is_chosen ? ErrorKind::usage : ErrorKind::device,
       "{}: {} leaves {} MiB for frames, too few for those around each: give {}, or --memory {}M", frame.depth_path(),
       memory.is_chosen ? "--memory" : "half of the free memory", memory.host_bytes / kMebibyte, mend,
       (memory.program_bytes + bytes_of_one(plan, frame, settings, frames, true)) / kMebibyte + 1);
}

void require_buffers_for_others(std::uint64_t most_bytes, const FrameSource& frame, const Settings& all) {
  require_buffers_for_estimates(most_bytes, frame, all);
  const InputSettings& settings = all.input;
  if (around_of(settings) == 0 && !settings.other_views) return;
  const auto bytes_of = [&](RawPlane plane) { return sizeof(float) * frame[plane].size() * frame.file_data.pixels(); };
  const std::uint64_t of_depth = bytes_of(RawPlane::depth), of_normals = bytes_of(RawPlane::normal);
  if (std::max(of_depth, of_normals) <= most_bytes) return;
  const char* const option = settings.other_views ? "--set other-views" : "--around";
  fail(ErrorKind::device,
       "{}: {} takes frames whole, and {} take a buffer of {} MiB, where the device has {} MiB at most: {}leave {} "
       "out, or use another --device",
       frame.depth_path(), option, of_depth > most_bytes ? "their depth" : "their normals",
       std::max(of_depth, of_normals) / kMebibyte, most_bytes / kMebibyte,
       of_depth > most_bytes ? "" : "give --normal none, ", option);
}

}  // namespace alcove
