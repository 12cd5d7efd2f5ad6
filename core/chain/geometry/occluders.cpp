// Host side of occluders.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/geometry/occluders.h"

#include "core/chain/base/pass_common.h"
#include "core/chain/geometry/matte.h"
#include "kernels/geometry/occluders.h"

namespace alcove {

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
                {"Hidden", gbuffer.hidden},
                {"Result", result.occluder_depth},
                {"Behind", result.occluder_hidden}},
               extent_of(view), {hidden});
  return result;
}

}  // namespace alcove
