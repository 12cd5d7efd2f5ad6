// Host side of completion.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/completion.h"

#include "core/chain/base/pass_common.h"
#include "kernels/estimate/completion.h"

namespace alcove {

gpu::Buffer* completion(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, const Sites& sites) {
  if (!estimate.completed) return nullptr;
  const View& view = gbuffer.view;
  const gpu::Extent tiles{groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
  gpu::Buffer& sums = gpu.buffer("completion", sizeof(vec2) * tiles.x * tiles.y);
  gpu.dispatch("completion",
               CompletionParams{view,
                                {gbuffer.grid.origin.x + sites.shift.x, gbuffer.grid.origin.y + sites.shift.y},
                                sites.spacing,
                                planes_in(*estimate.ao, view) - 1},
               {{"Depth", gbuffer.depth}, {"Ao", estimate.ao}, {"Completed", estimate.completed}, {"Sums", sums}},
               tiles);
  return &sums;
}

}  // namespace alcove
