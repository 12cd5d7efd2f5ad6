// Host side of matte.comp, needed.comp and occluders.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/geometry/matte.h"

#include <algorithm>

#include "kernels/geometry/geometry.h"

namespace alcove {
namespace {

uint form_of(MatteKind kind) {
  switch (kind) {
    case MatteKind::coverage: return kMatteCoverage;
    case MatteKind::objects: return kMatteNumbers;
    case MatteKind::ranked: return kMatteRanked;
  }
  return kMatteCoverage;
}

}  // namespace

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
