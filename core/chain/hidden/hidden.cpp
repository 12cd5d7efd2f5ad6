// Host side of the kernels that bring in what lies behind the first surface.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/hidden/hidden.h"

#include <algorithm>

#include "core/chain/base/pass_common.h"
#include "kernels/hidden/hidden.h"

namespace alcove {
namespace {

uint kind_of(BehindKind kind) {
  switch (kind) {
    case BehindKind::surfaces:
    case BehindKind::fronts: break;
    case BehindKind::backs: return kBehindBacks;
    case BehindKind::thickness: return kBehindThickness;
  }
  return kBehindSurfaces;
}

/// Which planes hold surfaces of unknown kind, a bit each.
uint open_planes(const FrameInputs& frame) {
  uint planes = 0;
  for (std::size_t i = 0; i < frame.behind.size(); i++)
    planes |= frame.behind[i].kind == BehindKind::surfaces ? 1u << i : 0u;
  return planes;
}

}  // namespace

gpu::Buffer& behind(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame) {
  gpu::Buffer& found = gpu.buffer("found behind", frame.behind.size() * plane_bytes(frame.view));
  for (uint plane = 0; plane < frame.behind.size(); plane++) {
    const LayerTerms& terms = frame.behind[plane];
    gpu.dispatch("behind", BehindParams{frame.view, terms.depth, plane},
                 {{"Raw", frame[RawPlane::behind]}, {"Depth", prepared.depth}, {"Found", found}}, extent_of(frame.view),
                 {terms.form, kind_of(terms.kind)});
  }
  return found;
}

gpu::Buffer& ends(gpu::Recorder& gpu, const GBuffer& layered) {
  gpu::Buffer& result = gpu.buffer("surface ends", 2 * plane_bytes(layered.view));
  for (const uint along_columns : {0u, 1u}) {
    const ivec2 size = layered.view.size;
    gpu.dispatch("ends", EndsParams{layered.view, along_columns},
                 {{"Depth", layered.depth}, {"Hidden", layered.hidden}, {"Result", result}},
                 {uint(along_columns ? size.x : size.y)}, {layered.surfaces - 1});
  }
  return result;
}

void pair(gpu::Recorder& gpu, const GBuffer& layered, const gpu::Buffer& open, const gpu::Buffer& ends) {
  gpu.dispatch("pair", PairParams{layered.view},
               {{"Depth", layered.depth}, {"Hidden", layered.hidden}, {"Open", open}, {"Ends", ends}},
               extent_of(layered.view), {layered.surfaces - 1});
}

Layering layering_of(const EstimatorSettings& settings) { return {settings.hidden, settings.separation.value_or(-1)}; }

GBuffer layers(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering) {
  const gpu::Buffer* warped = prepared.warped;
  if ((frame.behind.empty() && !warped) || layering.kept == 0) return prepared;
  const gpu::Buffer* found = frame.behind.empty() ? nullptr : &behind(gpu, prepared, frame);
  GBuffer gbuffer = prepared;
  // A pixel cannot hide more than was found of it.
  const uint planes = found ? planes_in(*found, prepared.view) : 0;
  const uint warped_planes = warped ? planes_in(*warped, prepared.view) : 0;
  const uint kept = std::min(uint(layering.kept), planes + warped_planes);
  gbuffer.surfaces = 1 + kept;
  gbuffer.hidden = &gpu.buffer("hidden", kept * plane_bytes(prepared.view));
  gbuffer.hides_no_more = !warped && frame.behind_lists_all;
  gbuffer.layer_counts = &gpu.buffer("layer counts", sizeof(LayerCounts));
  gpu.clear(*gbuffer.layer_counts);
  const gpu::Buffer& open = gpu.buffer("open surfaces", plane_bytes(prepared.view));
  const LayersParams params{prepared.view,
                            planes,
                            open_planes(frame),
                            warped_planes,
                            to_vec3(frame.hidden_precision.at),
                            float(layering.separation)};
  gpu.dispatch("layers", params,
               {{"Found", found},
                {"Depth", prepared.depth},
                {"Hidden", gbuffer.hidden},
                {"Counts", gbuffer.layer_counts},
                {"Warped", warped},
                {"Open", open}},
               extent_of(prepared.view), {kept});
  if (params.open_planes == 0) return gbuffer;
  const gpu::Buffer& ended = ends(gpu, gbuffer);
  pair(gpu, gbuffer, open, ended);
  return gbuffer;
}

gpu::Buffer& hidden_planes(gpu::Recorder& gpu, const GBuffer& gbuffer, const Layering& layering) {
  const auto kept = uint(layering.kept);
  gpu::Buffer& planes = gpu.buffer("hidden planes", 2 * kept * plane_bytes(gbuffer.view));
  gpu.dispatch("hidden_planes", HiddenPlanesParams{gbuffer.view, gbuffer.surfaces - 1, kept},
               {{"Hidden", gbuffer.hidden}, {"Planes", planes}}, extent_of(gbuffer.view));
  return planes;
}

}  // namespace alcove
