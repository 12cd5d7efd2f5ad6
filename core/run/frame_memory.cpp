// Rehearses the chain for its buffers, and adds up what reading and writing takes beside them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_memory.h"

#include <algorithm>
#include <limits>

#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/chain/chain.h"
#include "core/chain/margin.h"
#include "core/formats/exr_copy.h"
#include "core/run/composite_window.h"
#include "kernels/estimate.h"
#include "kernels/exact_search.h"

namespace alcove {
namespace {

/// A frame of that window without pixels, which has all that they may ask for.
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
  inputs.margin = margin_of(window, memory.file_data);
  const auto blocks = [](int side) { return std::size_t(side / kChangeBlock + 2); };
  inputs.changes =
      &rehearsal.buffer("changes", sizeof(uint) * blocks(window.width) * blocks(window.height), gpu::Use::upload);
  if (!memory.looks_at_others) return inputs;
  // Planes of others are counted with them: see shot_memory.
  OtherView other;
  other.view.size = {1, 1};
  other.depth = other.normal = other.moving = &rehearsal.buffer("other", sizeof(float), gpu::Use::upload);
  inputs.others = {other};
  return inputs;
}

/// What copying the beauty's file into the composite takes: rows of its channels, and two codecs.
std::uint64_t copied_bytes(const FrameSource& source, const OutputSettings& settings) {
  if (source[RawPlane::beauty].empty() || settings.composite_layers != "all") return 0;
  const ExrPart& part = source.part_of(source[RawPlane::beauty][0]);
  const std::uint64_t row = sizeof(float) * part.channels.size() * std::uint64_t(part.data.width);
  return kRowsOfOriginal * row + 2 * exr_codec_bytes(kRowsOfOutput * row);
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
  return {device, device + computed.pixels() * beside + fixed_bytes, rehearsal.largest_bytes()};
}

std::uint64_t FrameMemory::codec_bytes(std::uint64_t room) const {
  std::uint64_t bytes = 0;
  for (const std::uint64_t group : codec_groups) bytes += exr_codec_bytes(group, room / kCodecPart);
  return bytes;
}

FrameMemory memory_of(const FrameSource& source, const Settings& settings) {
  const bool appends_ao = !source[RawPlane::beauty].empty() && !settings.output.append_ao.empty();
  std::size_t written = source[RawPlane::beauty].size() + (appends_ao ? 1 : 0);
  for (const auto& aov : aovs_of(settings.output))
    written += channels_of(aov, planes_of(aov, settings.estimator)).size();
  // planes as shown, once more interleaved; two pictures, and both beside each other
  const std::size_t of_preview = settings.output.preview_style == "split" ? 18 : 6;
  // a number, its colour, that in bytes, and encoded
  const std::size_t of_view = settings.output.debug.empty() ? 0 : 6;
  const std::size_t pictures = std::max(of_view, settings.output.preview.empty() ? 0 : of_preview);
  FrameMemory memory;
  memory.reading = source;
  memory.file_data = source.file_data;
  for (const auto& row : kRawPlanes) memory.channels[row.plane] = source[row.plane].size();
  memory.estimator = settings.estimator;
  memory.estimator.radius = settings.estimator.radius.value_or(1);
  memory.wanted = settings.output;
  const InputSettings& input = settings.input;
  memory.looks_at_others = input.around > 0 || input.around_all || input.other_views;
  memory.written = sizeof(float) * written;
  // What is written may be there once more: cropped to a region, or as half.
  memory.beside = memory.written + sizeof(float) * pictures;
  memory.codec_groups = {kRowsOfOutput * memory.written * std::uint64_t(source.file_data.width)};
  memory.fixed_bytes =
      exr_codec_bytes(memory.codec_groups[0]) + copied_bytes(source, settings.output) + composite_bytes(source);
  for (const auto& file : source.files) {
    memory.fixed_bytes += file.bytes_beside_pixels();
    if (file.codec_group() > 0) memory.codec_groups.push_back(file.codec_group());
  }
  return memory;
}

std::uint64_t raw_bytes_of(const FrameSource& source) {
  std::uint64_t channels = 0;
  for (const auto& plane : source.planes.entries) channels += plane.size();
  return sizeof(float) * channels * source.file_data.pixels();
}

}  // namespace alcove
