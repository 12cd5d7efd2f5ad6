// Fills on the host what kernels would give for sky.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/open_sky.h"

#include <algorithm>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/geometry/geometry.h"
#include "kernels/estimate/estimate.h"

namespace alcove {

bool is_open_sky(const FrameInputs& frame, const EstimatorSettings& settings, const Wanted& wanted) {
  return frame.is_sky && !settings.no_skip && wanted.is_only_visibility() && !frame[RawPlane::beauty] &&
         !frame[RawPlane::material_ao] && !frame[RawPlane::matte];
}

FrameOutputs open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings) {
  const ivec2 size = block_grid(frame, int(settings.resolution)).size;
  const std::size_t bytes = plane_bytes(frame.view);
  FrameOutputs out;
  out.counts = &gpu.buffer("open sky counts", sizeof(FrameCounts), gpu::Use::upload);
  out.tiles = &gpu.buffer("open sky tile counts", sizeof(TileCounts), gpu::Use::upload);
  out.ao = &gpu.buffer("open sky", bytes, gpu::Use::upload);
  out.scales = &gpu.buffer("open sky scales", radii_of(settings).size() * bytes, gpu::Use::upload);
  out.counts->as<FrameCounts>()[0] = {uint(pixels_of(frame.view)), 0, 0, 0, 0, 0};
  out.tiles->as<TileCounts>()[0] = {{}, 0, groups_of(size.x, uint(kTile)) * groups_of(size.y, uint(kTile)), 0, 0};
  for (const auto* planes : {out.ao, out.scales}) std::ranges::fill(planes->as<float>(), 1.0f);
  return out;
}

}  // namespace alcove
