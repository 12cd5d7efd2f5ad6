// Rehearses the chain for its buffers, adds up what is taken beside them, and divides what is free among the frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/memory.h"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/system.h"
#include "core/chain/chain.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/geometry/geometry.h"
#include "core/formats/exr.h"
#include "core/frame/find/channels.h"
#include "core/frame/pixels/ramps.h"
#include "core/gpu/kernel.h"
#include "core/run/frame_files.h"
#include "kernels/estimate/estimate.h"
#include "kernels/estimate/exact.h"
#include "kernels/time/accumulate.h"

namespace alcove {
namespace {

/// A frame of that window without pixels, with every input that settings may ask for.
FrameInputs rehearsed_inputs(gpu::Recorder& rehearsal, const FrameMemory& memory, const Window& window) {
  Reading reading = memory.reading;
  reading.data = window;
  static_cast<Meaning&>(reading) = {};  // which may not be settled yet, and asks for no buffers
  for (auto& plane : reading.behind) plane.kind = BehindKind::surfaces;
  RawPlaneArray<gpu::Buffer*> planes;
  for (const auto& row : kRawPlanes)
    if (const std::size_t count = memory.channels[row.plane])
      planes[row.plane] = &rehearsal.buffer(row.name, sizeof(float) * count * window.pixels(), gpu::Use::upload);
  FrameInputs inputs = inputs_of(reading, planes, 0);
  inputs.is_sky = false;
  inputs.lights = memory.wanted.lights;
  inputs.margin = margin_of(window, memory.file_data);
  const auto blocks = [](int side) { return std::size_t(side / kChangeBlock + 2); };
  inputs.changes =
      &rehearsal.buffer("changes", sizeof(uint) * blocks(window.width) * blocks(window.height), gpu::Use::upload);
  if (!memory.looks_at_others) return inputs;
  // Planes of others are counted with the others.
  OtherView other;
  other.view.size = {1, 1};
  other.depth = other.normal = other.moving = &rehearsal.buffer("other", sizeof(float), gpu::Use::upload);
  inputs.others = {other};
  return inputs;
}

/// Bytes of a row of the beauty's file that is copied into the composite; 0 if none is.
std::uint64_t copied_row(const FrameSource& source, const OutputSettings& settings) {
  if (source.channels[RawPlane::beauty].empty() || settings.composite_layers != "all") return 0;
  const ExrPart& part = source.part_of(source.channels[RawPlane::beauty][0]);
  return sizeof(float) * part.channels.size() * std::uint64_t(part.data.width);
}

}  // namespace

int longest_side(const EstimatorSettings& settings) {
  if (!searches_exactly(settings)) return std::numeric_limits<int>::max();
  // kNoVertex stands for none.
  return int(kNoVertex) * int(settings.resolution);
}

FrameMemory::Bytes FrameMemory::of(const Window& computed) const {
  // No search numbers longer lines, so that a larger window is never computed at once.
  Window window = computed;
  window.width = std::min(window.width, longest_side(estimator));
  window.height = std::min(window.height, longest_side(estimator));
  gpu::Recorder rehearsal;
  run_chain(rehearsal, rehearsed_inputs(rehearsal, *this, window), estimator, wanted);
  const std::uint64_t device = rehearsal.bytes() + fixed_on_device;
  const std::uint64_t rows = std::uint64_t(std::min(kRowsWritten, computed.height)) * std::uint64_t(computed.width);
  // Rows that are written are there once more as half, and cropped to a region.
  const std::uint64_t copies = (is_cropped ? 2 : 1) * rows * written;
  return {device, device + computed.pixels() * beside + copies + fixed_bytes, rehearsal.largest_bytes()};
}

std::uint64_t FrameMemory::codec_bytes(std::uint64_t budget) const {
  std::uint64_t bytes = 0;
  for (const std::uint64_t group : codec_groups) bytes += exr_codec_bytes(group, budget / kCodecPart);
  return bytes;
}

void FrameMemory::take(const Settings& settings) {
  estimator = settings.estimator;
  estimator.radius = settings.estimator.radius.value_or(1);
  wanted = settings.output;
  looks_at_others = settings.input.around > 0 || settings.input.around_all || settings.input.other_views;
}

FrameMemory memory_of(const FrameSource& source, const Settings& settings) {
  const bool appends_ao = !source.channels[RawPlane::beauty].empty() && !settings.output.append_ao.empty();
  std::size_t written = source.channels[RawPlane::beauty].size() + (appends_ao ? 1 : 0);
  for (const auto& aov : aovs_of(settings.output))
    written += channels_of(aov, planes_of(aov, settings.estimator)).size();
  // planes as shown, once more interleaved; two pictures, and both beside each other
  const std::size_t of_preview = settings.output.preview_style == "split" ? 18 : 6;
  // a number, its colour, that in bytes, and encoded
  const std::size_t of_view = settings.output.debug.empty() ? 0 : 6;
  const std::size_t pictures = std::max(of_view, settings.output.preview.empty() ? 0 : of_preview);
  FrameMemory memory;
  memory.reading = source.reading;
  memory.file_data = source.reading.data;
  for (const auto& row : kRawPlanes) memory.channels[row.plane] = source.channels[row.plane].size();
  memory.take(settings);
  memory.written = sizeof(float) * written;
  memory.beside = sizeof(float) * pictures;
  memory.is_cropped = source.region.has_value();
  memory.codec_groups = {kRowsOfOutput * memory.written * std::uint64_t(source.reading.data.width)};
  const std::uint64_t copied = copied_row(source, settings.output);
  if (copied > 0) memory.codec_groups.insert(memory.codec_groups.end(), 2, kRowsOfOutput * copied);
  memory.fixed_bytes = kRowsOfOriginal * copied + composite_bytes(source);
  for (const std::uint64_t group : memory.codec_groups) memory.fixed_bytes += exr_codec_bytes(group);
  if (settings.input.ramps == "cut") memory.fixed_bytes += kRampBytes * source.reading.data.pixels();
  for (const auto& file : source.files) {
    memory.fixed_bytes += file.bytes_beside_pixels();
    if (file.codec_group() > 0) memory.codec_groups.push_back(file.codec_group());
  }
  return memory;
}

std::uint64_t raw_bytes_of(const FrameSource& source) {
  std::uint64_t channels = 0;
  for (const auto& plane : source.channels.entries) channels += plane.size();
  return sizeof(float) * channels * source.reading.data.pixels();
}

// What a run may take.

namespace {

/// The process without kernels and frames: libraries, and a device. 72 MiB were measured on lavapipe.
constexpr std::uint64_t kProcessBytes = 74ull << 20;
/// A further device on the CPU, without its kernels.
constexpr std::uint64_t kCpuLaneBytes = 8ull << 20;
/// Bytes that lavapipe and LLVM take for each byte of a kernel while the driver's cache is empty: 150 to 180 were
/// measured over the estimators, searches and AOVs. From a full cache a kernel takes half of them.
constexpr std::uint64_t kCompiledPart = 190;

/// The bytes of the kernels of a frame, as lavapipe holds them. A few pixels with all that options name have them all.
std::uint64_t kernel_bytes(const Settings& settings) {
  FrameMemory frame;
  frame.file_data = {0, 0, 32, 32};
  frame.channels[RawPlane::depth] = 1;
  frame.channels[RawPlane::normal] = 3;
  frame.channels[RawPlane::beauty] = settings.output.composite.empty() ? 0 : 3;
  if (settings.estimator.hidden > 0 && !(settings.input.behind[0] + settings.input.deep[0]).empty()) {
    frame.channels[RawPlane::behind] = 1;
    frame.reading.behind.resize(1);
  }
  frame.take(settings);
  gpu::Recorder rehearsal;
  run_chain(rehearsal, rehearsed_inputs(rehearsal, frame, frame.file_data), frame.estimator, frame.wanted);
  const std::set<gpu::KernelName> kernels(rehearsal.rehearsed().begin(), rehearsal.rehearsed().end());
  std::uint64_t bytes = 0;
  for (const auto& [stem, specialization] : kernels) bytes += kCompiledPart * gpu::kernel_code(stem).size_bytes();
  return bytes;
}

/// The process on a GPU at least.
constexpr std::uint64_t kProgramBytes = 176ull << 20;
/// Command buffers and queues of a further lane on a GPU.
constexpr std::uint64_t kGpuLaneBytes = 8ull << 20;
/// Host memory that a GPU's driver may take after its device was made, above all for its compiler.
constexpr std::uint64_t kDriverBytes = 96ull << 20;

/// The part of the device's free memory that is planned for. The rest is for drivers, which add to each of some 40
/// buffers of a frame in flight, and for other programs. A run that runs out computes fewer frames at once, so this
/// number decides about speed alone.
constexpr double kPlannedPart = 0.75;

MemoryBudget memory_with(const DeviceSettings& settings, std::uint64_t program_bytes, std::uint64_t lane_bytes) {
  const std::uint64_t allowed = settings.memory ? settings.memory : free_memory() / 2;
  return {.bytes = std::max(settings.least_memory, allowed - std::min(allowed, program_bytes)),
          .program_bytes = program_bytes,
          .lane_bytes = lane_bytes,
          .is_chosen = settings.memory > 0};
}

}  // namespace

MemoryBudget memory_of_host(const Settings& settings) {
  const std::uint64_t kernels = kernel_bytes(settings);
  return memory_with(settings.device, kProcessBytes + kernels, kCpuLaneBytes + kernels);
}

MemoryBudget memory_for_frames(const Settings& settings, const gpu::DeviceInfo& device) {
  // A CPU device computes in host memory, which is counted already. An integrated GPU's memory is counted as both: its
  // driver may give away less of it than the host has.
  MemoryBudget memory;
  if (device.type == gpu::DeviceType::cpu) {
    memory = memory_of_host(settings);
  } else {
    const std::uint64_t program_bytes = std::max(kProgramBytes, resident_memory_bytes() + kDriverBytes);
    memory = memory_with(settings.device, program_bytes, kGpuLaneBytes);
    memory.device_bytes = std::uint64_t(kPlannedPart * double(device.free_bytes));
  }
  memory.buffer_bytes = device.buffer_bytes;
  return memory;
}

MemoryBudget budget_of_lane(MemoryBudget memory, int lanes) {
  const auto count = std::uint64_t(lanes);
  memory.bytes = (memory.bytes - std::min(memory.bytes, (count - 1) * memory.lane_bytes)) / count;
  memory.device_bytes /= count;
  return memory;
}

// What frames see of each other.

namespace {

constexpr std::size_t kPlanesOfView = 3;    // depth, normals, what moves
constexpr std::size_t kPlanesPrepared = 5;  // that passes make of it: depth, normals, flags, what moves, surfels

/// Planes of values of an estimate: see EstimateSet.
std::size_t values_of(const Settings& settings) {
  const std::size_t further = settings.estimator.further_radii.size();
  const Wanted wanted(settings.output);
  return 1 + (further > 0 ? 1 + further : 0) + moments_in(moment_order(settings.estimator, wanted)) +
         (wanted.needs_curvature() ? 2 * (1 + further) : 0);
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
  return sizeof(float) * (frame.reading.data.pixels() * (taken + own + sums + suspects) + kMovedCells);
}

/// What it takes to read the motion vectors of a frame, and to mark what moves: up to two pairs of planes.
std::uint64_t bytes_of_motion(const FrameSource& frame, const InputSettings& settings) {
  if (settings.motion.empty() || !takes_frames(settings)) return 0;
  const std::size_t planes = settings.motion_channels.find(',') == std::string::npos ? 4 : 2;
  return frame.reading.data.pixels() * (planes * sizeof(float) + sizeof(std::uint8_t));
}

/// What one frame at a time takes with all around it: as a whole, or at least, in the smallest of tiles.
std::uint64_t bytes_of_one(const FramePlan& plan, const FrameSource& frame, const Settings& settings,
                           std::span<const int> frames, bool is_whole) {
  const FrameMemory memory = memory_with_others(plan, frame, settings);
  return bytes_of_shot(plan, frame, settings.input, 1) + bytes_of_estimates(plan, frame, settings, frames, 1) +
         (is_whole ? memory.of(frame.reading.data).host : memory.fixed_on_device + memory.fixed_bytes);
}

/// Fails as require_buffers_for_others() does, with the estimates that frames take of each other.
void require_buffers_for_estimates(std::uint64_t most_bytes, const FrameSource& frame, const Settings& settings) {
  if (settings.input.accumulate == 0) return;
  const std::size_t values = values_of(settings), planes = std::max(values, 2 + values / 2);
  const std::uint64_t bytes = sizeof(float) * planes * frame.reading.data.pixels();
  if (bytes <= most_bytes) return;
  fail(ErrorKind::device,
       "{}: --accumulate keeps a frame's estimates in one buffer of {} MiB, and the device has {} MiB at most: leave "
       "it out, {}or use another --device",
       frame.depth_path(), bytes / kMebibyte, most_bytes / kMebibyte,
       values > 1 ? "ask for one --radius and no directions, " : "");
}

}  // namespace

std::size_t most_others(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings) {
  const std::size_t around =
      around_of(settings) == 0 ? 0 : std::min(plan.shot().size(), 2 * std::size_t(around_of(settings)));
  return around + (settings.other_views ? views_of(frame.files[frame.channels[RawPlane::depth][0].file]).size() : 0);
}

FrameMemory memory_with_others(const FramePlan& plan, const FrameSource& frame, const Settings& settings) {
  FrameMemory memory = memory_of(frame, settings);
  memory.fixed_on_device = bytes_of_mean(plan, frame, settings);
  memory.fixed_bytes += bytes_of_motion(frame, settings.input);
  const std::size_t others = most_others(plan, frame, settings.input);
  if (!takes_others(settings.input)) return memory;
  // What tells what moves in one of them takes those around it.
  const int count = around_of(settings.input);
  const std::size_t witnesses = count == 0 ? 0 : std::min(plan.shot().size(), std::size_t(most_witnesses(count)));
  const std::size_t buffers = others == 0 ? 0 : kPlanesOfView * std::max(others, witnesses + 1);
  const std::size_t prepared =
      frame.channels[RawPlane::depth].size() + frame.channels[RawPlane::normal].size() + kPlanesPrepared;
  memory.fixed_on_device += sizeof(float) * frame.reading.data.pixels() * (buffers + prepared);
  return memory;
}

std::uint64_t bytes_of_shot(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings, int lanes) {
  if (!takes_frames(settings)) return 0;
  const std::uint64_t around = 2 * std::uint64_t(farthest_seen(around_of(settings))) + 1;
  // All frames of a mean look at others, and near the ends of the shot they all lie on one side. Frames that are
  // computed at once may lie far from each other.
  const std::uint64_t means = 2 * std::uint64_t(settings.accumulate);
  const std::uint64_t window = std::uint64_t(lanes) * (around + means) + means;
  return kPlanesOfView * sizeof(float) * frame.reading.data.pixels() *
         std::min<std::uint64_t>(plan.shot().size(), window);
}

std::uint64_t bytes_of_estimates(const FramePlan& plan, const FrameSource& frame, const Settings& settings,
                                 std::span<const int> frames, int lanes) {
  if (settings.input.accumulate == 0) return 0;
  // What was read of one is kept with its estimate until it is computed itself, as at first none of them is.
  return (sizeof(float) * frame.reading.data.pixels() * (2 + values_of(settings)) + raw_bytes_of(frame)) *
         most_estimates(plan, frames, std::size_t(lanes));
}

MemoryBudget without_shared_frames(MemoryBudget memory, const FramePlan& plan, const FrameSource& frame,
                                   const Settings& settings, std::span<const int> frames, int lanes) {
  const std::uint64_t bytes = std::min(memory.bytes, bytes_of_shot(plan, frame, settings.input, lanes) +
                                                         bytes_of_estimates(plan, frame, settings, frames, lanes));
  memory.bytes -= bytes;
  memory.program_bytes += bytes;
  return memory;
}

int frames_at_once(const MemoryBudget& memory, const FramePlan& plan, const FrameSource& frame,
                   const Settings& settings, std::span<const int> frames, int most) {
  const FrameMemory::Bytes of_frame = memory_with_others(plan, frame, settings).of(frame.reading.data);
  int count = int(std::min(frames.size(), std::size_t(most)));
  const auto has_room = [&] {
    const MemoryBudget left = without_shared_frames(memory, plan, frame, settings, frames, count);
    return std::min((left.bytes + left.lane_bytes) / (of_frame.host + left.lane_bytes),
                    left.device_bytes / of_frame.device) >= std::uint64_t(count);
  };
  while (count > 1 && !has_room()) count--;
  return std::max(1, count);
}

int threads_of(const DeviceSettings& settings) { return settings.threads > 0 ? settings.threads : core_count(); }

void require_room_for_others(const MemoryBudget& memory, const FramePlan& plan, const FrameSource& frame,
                             const Settings& settings, std::span<const int> frames) {
  const InputSettings& input = settings.input;
  if (around_of(input) == 0 && input.accumulate == 0) return;
  if (bytes_of_one(plan, frame, settings, frames, false) <= memory.bytes) return;
  Settings fewer = settings;
  fewer.input.around = int(std::min<std::size_t>(plan.shot().size(), std::size_t(around_of(input))));
  fewer.input.around_all = false;
  while (fewer.input.around > 0 && bytes_of_one(plan, frame, fewer, frames, true) > memory.bytes) fewer.input.around--;
  const std::string mend = input.accumulate > 0 ? fmt::format("a smaller --accumulate than {}", input.accumulate)
                                                : fmt::format("--around {}", fewer.input.around);
  fail(memory.is_chosen ? ErrorKind::usage : ErrorKind::device,
       "{}: {} leaves {} MiB for frames, too few for each frame's neighbours: give {}, or --memory {}M",
       frame.depth_path(), memory.is_chosen ? "--memory" : "half of the free memory", memory.bytes / kMebibyte, mend,
       (memory.program_bytes + bytes_of_one(plan, frame, settings, frames, true)) / kMebibyte + 1);
}

void require_buffers_for_others(std::uint64_t most_bytes, const FrameSource& frame, const Settings& all) {
  require_buffers_for_estimates(most_bytes, frame, all);
  const InputSettings& settings = all.input;
  if (around_of(settings) == 0 && !settings.other_views) return;
  const auto bytes_of = [&](RawPlane plane) {
    return sizeof(float) * frame.channels[plane].size() * frame.reading.data.pixels();
  };
  const std::uint64_t of_depth = bytes_of(RawPlane::depth), of_normals = bytes_of(RawPlane::normal);
  if (std::max(of_depth, of_normals) <= most_bytes) return;
  const char* const option = settings.other_views ? "--set other-views" : "--around";
  fail(ErrorKind::device,
       "{}: {} keeps frames whole, and {} take a buffer of {} MiB, while the device has {} MiB at most: {}leave {} "
       "out, or use another --device",
       frame.depth_path(), option, of_depth > most_bytes ? "their depth" : "their normals",
       std::max(of_depth, of_normals) / kMebibyte, most_bytes / kMebibyte,
       of_depth > most_bytes ? "" : "give --normal none, ", option);
}

}  // namespace alcove
