// Host side of the kernels of the quick search.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/quick/quick.h"

#include "core/chain/base/planes.h"
#include "kernels/quick/quick.h"

namespace alcove {

bool searches_quickly(const EstimatorSettings& settings, const GBuffer& gbuffer, uint order, bool with_curvature) {
  const bool is_usual = settings.estimator == Estimator::gtao && settings.falloff == Falloff::none &&
                        settings.thickness == ThicknessKind::automatic && settings.complete == Completion::all &&
                        settings.resolution == Resolution::full && settings.further_radii.empty();
  const bool is_plain = order == 0 && !with_curvature && gbuffer.surfaces == 1 && !gbuffer.occluder_depth;
  return settings.search == SliceSearch::quick && settings.tolerance == 0 && is_adaptive(settings) && is_usual &&
         is_plain;
}

const gpu::Buffer& margin(gpu::Recorder& gpu, const GBuffer& gbuffer) {
  const ivec2 size = gbuffer.view.size;
  const uint beside = 2 * uint(kDepthMargin), width = uint(size.x) + beside, height = uint(size.y) + beside;
  const gpu::Buffer& wide = gpu.buffer("depth with margin", sizeof(float) * width * height);
  gpu.dispatch("margin", MarginParams{gbuffer.view},
               {{"Depth", gbuffer.depth}, {"Normal", gbuffer.normal}, {"Wide", wide}},
               {width * height - uint(size.x) * uint(size.y)});
  return wide;
}

Estimate quick_horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const gpu::Buffer& wide,
                       const FrameInputs& frame, const EstimatorSettings& settings) {
  const Reach reach = reach_of(settings, *settings.radius);
  const Sampling sampling = sampling_of(settings, frame.frame);
  Estimate result{&gpu.buffer("ao", plane_bytes(gbuffer.view))};
  result.listed.site_counts = sites.counts;
  gpu.dispatch(
      "quick_horizon",
      QuickParams{gbuffer.view, sites.grid, reach.radius, reach.bias, gbuffer.grid.origin, sampling.noise_shift,
                  gbuffer.depth_precision},
      {{"Wide", wide}, {"Normal", gbuffer.normal}, {"List", sites.list}, {"Counts", sites.counts}, {"Ao", result.ao}},
      sites.extent, {uint(sampling.slices), uint(sampling.steps)});
  return result;
}

}  // namespace alcove
