// Host side of the kernels that make the G-buffer, put a margin around it and cut it off again, and read mattes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/geometry/geometry.h"

#include <algorithm>

#include "kernels/geometry/geometry.h"

namespace alcove {
namespace {

/// The margin's part of the frame's width, on each side: one of so many.
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

uint form_of(MatteKind kind) {
  switch (kind) {
    case MatteKind::coverage: return kMatteCoverage;
    case MatteKind::objects: return kMatteNumbers;
    case MatteKind::ranked: return kMatteRanked;
  }
  return kMatteCoverage;
}

}  // namespace

const gpu::Buffer& occluder_depth_of(const GBuffer& gbuffer) {
  return gbuffer.occluder_depth ? *gbuffer.occluder_depth : *gbuffer.depth;
}

const gpu::Buffer* occluder_hidden_of(const GBuffer& gbuffer) {
  return gbuffer.occluder_hidden ? gbuffer.occluder_hidden : gbuffer.hidden;
}

BlockGrid block_grid(const FrameInputs& frame, int factor) {
  const auto floored = [&](int px) { return px / factor - (px % factor < 0 ? 1 : 0); };
  const ivec2 begin = frame.noise_origin;
  const ivec2 size = frame.view.size;
  BlockGrid grid;
  grid.factor = factor;
  grid.origin = {floored(begin.x), floored(begin.y)};
  grid.overhang = {begin.x - factor * grid.origin.x, begin.y - factor * grid.origin.y};
  grid.size = {floored(grid.overhang.x + size.x + factor - 1), floored(grid.overhang.y + size.y + factor - 1)};
  grid.frame_size = size;
  return grid;
}

ImagePart without_margin(const FrameInputs& frame, const BlockGrid& grid, int around) {
  const auto& [before, after] = frame.margin;
  const auto from = [&](int px, int overhang) { return std::max(0, (px - around + overhang) / grid.factor); };
  const auto to = [&](int px, int overhang, int blocks) {
    return std::min(blocks, (px + around + overhang + grid.factor - 1) / grid.factor);
  };
  const ivec2 overhang = grid.overhang, size = frame.view.size;
  return {{from(before.x, overhang.x), from(before.y, overhang.y)},
          {to(size.x - after.x, overhang.x, grid.size.x), to(size.y - after.y, overhang.y, grid.size.y)}};
}

GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, const std::string& prefix) {
  const gpu::Buffer& raw_depth = *frame[RawPlane::depth];
  const gpu::Buffer* raw_normal = frame[RawPlane::normal];
  GBuffer gbuffer;
  gbuffer.view = frame.view;
  gbuffer.grid = block_grid(frame, 1);
  gbuffer.depth_precision = to_vec3(frame.depth_precision.at);
  gbuffer.depth = &gpu.buffer(prefix + "depth", plane_bytes(frame.view));
  gbuffer.normal = &gpu.buffer(prefix + "normal", plane_bytes(frame.view));
  gbuffer.counts = &gpu.buffer(prefix + "counts", sizeof(FrameCounts));
  gbuffer.missing = &gpu.buffer(prefix + "missing", sizeof(GroupCount));
  gpu.clear(*gbuffer.counts);
  gpu.write(*gbuffer.missing,
            GroupCount{groups_of(frame.view.size.x, kGroupX), groups_of(frame.view.size.y, kGroupY), 0});
  gpu.dispatch("prepare", frame.prepare,
               {{"RawDepth", raw_depth},
                {"RawNormal", gpu::Optional(raw_normal)},
                {"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Counts", gbuffer.counts},
                {"Missing", gbuffer.missing}},
               {uint(frame.view.size.x), groups_of(frame.view.size.y, kPrepareRun)},
               {frame.depth_map.form, raw_normal ? frame.normal_form : kNormalNone});
  return gbuffer;
}

GBuffer reconstruct(gpu::Recorder& gpu, const GBuffer& gbuffer) {
  gpu.dispatch("reconstruct", ReconstructParams{gbuffer.view},
               {{"Depth", gbuffer.depth}, {"Normal", gbuffer.normal}, {"Counts", gbuffer.counts}},
               gpu::Extent(*gbuffer.missing));
  return gbuffer;
}

GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const BlockGrid& grid, const std::string& prefix) {
  if (grid.factor == 1) return gbuffer;
  const auto factor = float(grid.factor);
  GBuffer low = gbuffer;
  low.grid = grid;
  low.view.size = grid.size;
  low.view.center = {(gbuffer.view.center.x + float(grid.overhang.x)) / factor,
                     (gbuffer.view.center.y + float(grid.overhang.y)) / factor};
  low.view.tangent_per_pixel = {gbuffer.view.tangent_per_pixel.x * factor, gbuffer.view.tangent_per_pixel.y * factor};
  low.occluder_depth = low.occluder_hidden = nullptr;
  const uint hidden = gbuffer.surfaces - 1;
  if (gbuffer.hidden) low.hidden = &gpu.buffer(prefix + "low hidden", hidden * plane_bytes(low.view));
  low.depth = &gpu.buffer(prefix + "low depth", plane_bytes(low.view));
  low.normal = &gpu.buffer(prefix + "low normal", plane_bytes(low.view));
  gpu.dispatch("downsample", DownsampleParams{gbuffer.view, grid.size, grid.overhang, hidden},
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"LowDepth", low.depth},
                {"LowNormal", low.normal},
                {"Hidden", gpu::Optional(gbuffer.hidden)},
                {"LowHidden", gpu::Optional(low.hidden)}},
               extent_of(low.view), {uint(grid.factor)});
  if (!gbuffer.occluder_depth) return low;
  GBuffer blocking = gbuffer;
  blocking.depth = gbuffer.occluder_depth;
  blocking.hidden = gbuffer.occluder_hidden;
  blocking.occluder_depth = blocking.occluder_hidden = nullptr;
  const GBuffer low_blocking = downsample(gpu, blocking, grid, "occluder ");
  low.occluder_depth = low_blocking.depth;
  low.occluder_hidden = low_blocking.hidden;
  return low;
}

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
  return {cut(gpu, frame, wide.ao, "ao"), cut(gpu, frame, wide.scales, "scales"),
          cut(gpu, frame, wide.moments, "moments")};
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

Matte matte(gpu::Recorder& gpu, const FrameInputs& frame, RawPlane which) {
  const gpu::Buffer* raw = frame[which];
  if (!raw) return {};
  const bool is_of_receivers = which == RawPlane::matte;
  const MatteReading& reading = is_of_receivers ? frame.matte : frame.occluders;
  const std::string prefix = is_of_receivers ? "" : "occluder ";
  const auto& wanted = reading.objects;
  gpu::Buffer& objects =
      gpu.buffer(prefix + "matte objects", std::max<std::size_t>(1, wanted.size()) * sizeof(uint), gpu::Use::upload);
  std::ranges::partial_sort_copy(wanted, objects.as<uint>());
  gpu::Buffer& result = gpu.buffer(prefix + "matte", plane_bytes(frame.view));
  const bool is_ranked = reading.kind == MatteKind::ranked;
  gpu.dispatch("matte", MatteParams{frame.view.size, uint(wanted.size())},
               {{"Raw", raw}, {"Objects", objects}, {"Result", result}}, extent_of(frame.view),
               {form_of(reading.kind), is_ranked ? planes_in(*raw, frame.view) / 2 : 1});
  return {&result, reading.outside};
}

GBuffer needed(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& wide, const Matte& matte, int reach) {
  if (!matte.plane) return gbuffer;
  const View& view = gbuffer.view;
  const BlockGrid& grid = gbuffer.grid;
  const gpu::Extent tiles = tile_extent(view);
  GBuffer result = gbuffer;
  result.needed = &gpu.buffer("needed", sizeof(uint) * tiles.x * tiles.y);
  gpu.clear(*result.needed);
  const auto& [before, after] = wide.margin;
  const ivec2 whole = wide.view.size;
  gpu.dispatch("needed",
               NeededParams{view.size,
                            {whole.x - before.x - after.x, whole.y - before.y - after.y},
                            {-grid.overhang.x - before.x, -grid.overhang.y - before.y},
                            (reach + grid.factor - 1) / grid.factor},
               {{"Matte", matte.plane}, {"Tiles", result.needed}}, tiles, {uint(grid.factor)});
  return result;
}

GBuffer occluders(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, Unknown unknown) {
  const gpu::Buffer* counted = matte(gpu, frame, RawPlane::occluders).plane;
  if (!counted) return gbuffer;
  const View& view = gbuffer.view;
  const bool keeps = unknown == Unknown::blocked;
  const std::string prefix = keeps ? "bracket " : "";
  const uint hidden = gbuffer.surfaces - 1;
  GBuffer result = gbuffer;
  result.occluder_depth = &gpu.buffer(prefix + "occluder depth", plane_bytes(view));
  if (hidden > 0) result.occluder_hidden = &gpu.buffer(prefix + "occluder hidden", hidden * plane_bytes(view));
  const OccludersParams params{view, frame.occluders.ignores ? 1u : 0u, keeps ? 1u : 0u,
                               gbuffer.hides_no_more ? 1u : 0u};
  gpu.dispatch("occluders", params,
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Matte", counted},
                {"Hidden", gpu::Optional(gbuffer.hidden)},
                {"Result", result.occluder_depth},
                {"Behind", gpu::Optional(result.occluder_hidden)}},
               extent_of(view), {hidden});
  return result;
}

}  // namespace alcove
