// Host side of debug.comp: what each view takes beside the G-buffer.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/debug.h"

#include "core/chain/base/pass_common.h"
#include "kernels/results/debug.h"

namespace alcove {
namespace {

/// The normals that the frame would have without any of its own.
const gpu::Buffer* normals_from_depth(gpu::Recorder& gpu, FrameInputs frame) {
  frame[RawPlane::normal] = nullptr;
  return reconstruct(gpu, prepare(gpu, frame, "debug ")).normal;
}

}  // namespace

DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame) {
  const GBuffer* shown = &gbuffer;
  const gpu::Buffer* values = gbuffer.normal;
  Sites sites;
  uint hidden = 0;
  switch (view.source) {
    case DebugSource::none: break;
    case DebugSource::raw_depth: values = frame[RawPlane::depth]; break;
    case DebugSource::normals_from_depth: values = normals_from_depth(gpu, frame); break;
    case DebugSource::raw_ao:
      shown = &stages.gbuffer;
      values = stages.raw_ao;
      sites = stages.sites;
      break;
    case DebugSource::denoised_ao:
      shown = &stages.gbuffer;
      values = stages.denoised_ao;
      break;
    case DebugSource::completed:
      shown = &stages.gbuffer;
      values = stages.completed;
      sites = stages.sites;
      break;
    case DebugSource::sites:
      shown = &stages.gbuffer;
      sites = stages.sites;
      break;
    case DebugSource::hidden:
      if (gbuffer.hidden) values = gbuffer.hidden;
      hidden = gbuffer.surfaces - 1;
      break;
    case DebugSource::count:
      if (stages.count) values = stages.count;
      break;
    case DebugSource::tiles:
      shown = &stages.gbuffer;
      values = stages.kinds;
      break;
  }
  gpu::Buffer& result = gpu.buffer(std::string("debug ") + view.name, plane_bytes(shown->view));
  gpu.dispatch("debug", DebugParams{shown->view, view.kind, sites.rows ? 1u : 0u, shown->grid.origin, hidden},
               {{"Depth", shown->depth},
                {"Normal", shown->normal},
                {"Values", values},
                {"Result", result},
                {"Rows", sites.rows}},
               extent_of(shown->view));
  return {&view, shown->view.size, &result};
}

}  // namespace alcove
