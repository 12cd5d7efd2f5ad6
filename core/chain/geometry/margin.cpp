// Host side of the kernels that put a margin around the frame and cut it off again.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/geometry/margin.h"

#include "core/chain/base/pass_common.h"
#include "kernels/geometry/margin.h"

namespace alcove {
namespace {

/// Of the frame's width, on each side.
constexpr int kMarginPart = 8;

/// Surfaces that files show behind the first end with the frame, and so does then what others show.
bool has_margin(const FrameInputs& frame) {
  const auto& [before, after] = frame.margin;
  return before.x + before.y + after.x + after.y > 0 && !frame.others.empty() && frame.behind.empty();
}

void run_widen(gpu::Recorder& gpu, const GBuffer& prepared, const GBuffer& wide, const FrameInputs& frame,
               const gpu::Buffer& found, uint stage) {
  gpu.dispatch("widen", WidenParams{prepared.view, wide.view, frame.margin.before},
               {{"Depth", prepared.depth},
                {"Normal", prepared.normal},
                {"Found", found},
                {"WideDepth", wide.depth},
                {"WideNormal", wide.normal}},
               extent_of(wide.view), {stage});
}

}  // namespace

Margin margin_of(const Window& part, const Window& frame) {
  const int px = frame.width / kMarginPart;
  const auto at = [&](bool ends) { return ends ? px : 0; };
  return {{at(part.x == frame.x), at(part.y == frame.y)},
          {at(part.x + part.width == frame.x + frame.width), at(part.y + part.height == frame.y + frame.height)}};
}

FrameInputs with_margin(const FrameInputs& frame) {
  const auto& [before, after] = frame.margin;
  FrameInputs wide = frame;
  if (!has_margin(frame)) {
    wide.margin = {};
    return wide;
  }
  wide.view.size = {frame.view.size.x + before.x + after.x, frame.view.size.y + before.y + after.y};
  wide.view.center = {frame.view.center.x + float(before.x), frame.view.center.y + float(before.y)};
  wide.noise_origin = {frame.noise_origin.x - before.x, frame.noise_origin.y - before.y};
  wide.changes = nullptr;
  return wide;
}

GBuffer widen(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame) {
  if (!has_margin(frame)) return prepared;
  const FrameInputs inputs = with_margin(frame);
  GBuffer wide = prepared;
  wide.view = inputs.view;
  wide.grid = block_grid(inputs, 1);
  wide.depth = &gpu.buffer("wide depth", plane_bytes(wide.view));
  wide.normal = &gpu.buffer("wide normal", plane_bytes(wide.view));
  wide.missing = &gpu.buffer("wide missing", sizeof(GroupCount));
  gpu.write(*wide.missing, GroupCount{groups_of(wide.view.size.x, kGroupX), groups_of(wide.view.size.y, kGroupY), 1});
  run_widen(gpu, prepared, wide, frame, *prepared.depth, kWidenEmpty);
  return wide;
}

void widen(gpu::Recorder& gpu, const GBuffer& prepared, const GBuffer& wide, const FrameInputs& frame,
           const gpu::Buffer& found) {
  if (!has_margin(frame)) return;
  run_widen(gpu, prepared, wide, frame, found, kWidenFilled);
  reconstruct(gpu, wide);
}

gpu::Buffer* cut(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Buffer* planes, const std::string& name) {
  if (!planes || !has_margin(frame)) return planes;
  const View wide = with_margin(frame).view;
  const uint count = planes_in(*planes, wide);
  gpu::Buffer& result = gpu.buffer("cut " + name, count * plane_bytes(frame.view));
  gpu.dispatch("cut", CutParams{frame.view.size, wide.size, frame.margin.before, count},
               {{"Wide", planes}, {"Result", result}}, extent_of(frame.view));
  return &result;
}

Visibility cut(gpu::Recorder& gpu, const FrameInputs& frame, const Visibility& wide) {
  return {cut(gpu, frame, wide.ao, "ao"), cut(gpu, frame, wide.scales, "scales"), cut(gpu, frame, wide.bent, "bent")};
}

GBuffer cut(gpu::Recorder& gpu, const FrameInputs& frame, const GBuffer& wide, const GBuffer& prepared) {
  if (!has_margin(frame)) return wide;
  GBuffer narrow = wide;
  narrow.view = prepared.view;
  narrow.grid = prepared.grid;
  narrow.depth = prepared.depth;
  narrow.normal = cut(gpu, frame, wide.normal, "normal");
  narrow.hidden = cut(gpu, frame, wide.hidden, "hidden");
  return narrow;
}

}  // namespace alcove
