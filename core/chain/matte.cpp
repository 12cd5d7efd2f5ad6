// Host side of matte.comp and receivers.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/matte.h"

#include <algorithm>

#include "core/chain/pass_common.h"
#include "kernels/matte.h"
#include "kernels/receivers.h"

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

Matte matte(gpu::Recorder& gpu, const FrameInputs& frame) {
  const gpu::Buffer* raw = frame[RawPlane::matte];
  if (!raw) return {};
  const auto& wanted = frame.matte.objects;
  gpu::Buffer& objects =
      gpu.buffer("matte objects", std::max<std::size_t>(1, wanted.size()) * sizeof(uint), gpu::Use::upload);
  std::ranges::copy(wanted, objects.as<uint>().begin());
  gpu.upload(objects);
  gpu::Buffer& result = gpu.buffer("matte", plane_bytes(frame.view), gpu::Use::device);
  const bool is_ranked = frame.matte.kind == MatteKind::ranked;
  gpu.dispatch("matte", MatteParams{frame.view.size, uint(wanted.size())},
               {{kMatteRaw, *raw}, {kMatteObjects, objects}, {kMatteResult, result}}, extent_of(frame.view),
               {form_of(frame.matte.kind), is_ranked ? planes_in(*raw, frame.view) / 2 : 1});
  return {&result, frame.matte.outside};
}

GBuffer receivers(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const Matte& matte, int reach) {
  if (!matte.plane) return gbuffer;
  const View& view = gbuffer.view;
  const BlockGrid& grid = gbuffer.grid;
  const gpu::Extent tiles{groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
  GBuffer result = gbuffer;
  result.receivers = &gpu.buffer("receivers", sizeof(uint) * tiles.x * tiles.y, gpu::Use::device);
  gpu.clear(*result.receivers);
  const ivec2 before = frame.margin.before;
  const int tile = kTile * grid.factor;  // px of the frame
  gpu.dispatch("receivers",
               ReceiversParams{view.size,
                               frame.view.size,
                               {-grid.overhang.x - before.x, -grid.overhang.y - before.y},
                               (reach + tile - 1) / tile},
               {{kReceiversMatte, *matte.plane}, {kReceiversTiles, *result.receivers}}, tiles, {uint(grid.factor)});
  return result;
}

}  // namespace alcove
