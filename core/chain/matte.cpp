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
  gpu.dispatch(
      "matte",
      MatteParams{frame.view.size, form_of(frame.matte.kind), planes_in(*raw, frame.view), uint(wanted.size())},
      {{kMatteRaw, *raw}, {kMatteObjects, objects}, {kMatteResult, result}}, extent_of(frame.view));
  return {&result, frame.matte.outside};
}

GBuffer receivers(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const Matte& matte,
                  int reach) {
  if (!matte.plane) return gbuffer;
  const View& view = gbuffer.view;
  const BlockGrid& grid = gbuffer.grid;
  const std::size_t tiles = std::size_t(groups_of(view.size.x, uint(kTile))) * groups_of(view.size.y, uint(kTile));
  GBuffer result = gbuffer;
  result.receivers = &gpu.buffer("receivers", tiles * sizeof(uint), gpu::Use::device);
  gpu.clear(*result.receivers);
  const ivec2 before = frame.margin.before;
  const int tile = kTile * grid.factor;  // px of the frame
  gpu.dispatch("receivers",
               ReceiversParams{view.size,
                               frame.view.size,
                               {-grid.overhang.x - before.x, -grid.overhang.y - before.y},
                               grid.factor,
                               (reach + tile - 1) / tile},
               {{kReceiversMatte, *matte.plane}, {kReceiversTiles, *result.receivers}}, extent_of(view));
  return result;
}

}  // namespace alcove
