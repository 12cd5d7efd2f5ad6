// Host side of the kernels that make the G-buffer.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/geometry/geometry.h"

#include <algorithm>

#include "core/chain/base/pass_common.h"
#include "kernels/geometry/geometry.h"

namespace alcove {

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
                {"RawNormal", raw_normal},
                {"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Counts", gbuffer.counts},
                {"Missing", gbuffer.missing}},
               extent_of(frame.view), {frame.depth_map.form, raw_normal ? frame.normal_form : kNormalNone});
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
                {"Hidden", gbuffer.hidden},
                {"LowHidden", low.hidden}},
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

}  // namespace alcove
