// The order of the passes: one line each, and nothing else.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/chain.h"

#include <algorithm>

#include "core/chain/aov.h"

namespace alcove {
namespace {

/// Whether nothing is asked for but AO that is made from depth and normals alone.
bool is_only_visibility(const FrameInputs& frame, const OutputSettings& output) {
  const bool has_others = std::ranges::any_of(aovs_of(output), [](const Aov& aov) {
    return aov.planes != &FrameOutputs::ao && aov.planes != &FrameOutputs::scales;
  });
  return !has_others && needs_ao(output) && !output.multi_bounce && !frame.beauty && !frame.material_ao &&
         debug_views_of(output).empty();
}

}  // namespace

FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                       const OutputSettings& output) {
  FrameOutputs out;
  if (frame.is_sky && !settings.no_skip && is_only_visibility(frame, output)) {
    const OpenSky sky = open_sky(gpu, frame, settings);
    out.counts = sky.counts, out.tiles = sky.tiles, out.ao = sky.ao, out.scales = sky.scales;
    return out;
  }
  for (const auto* plane :
       {frame.depth, frame.normal, frame.beauty, frame.indirect, frame.diffuse_color, frame.material_ao, frame.albedo})
    if (plane) gpu.upload(*plane);

  const GBuffer gbuffer =
      prepare(gpu, frame, wants(output, &FrameOutputs::depth) ? gpu::Use::download : gpu::Use::device);
  reconstruct(gpu, gbuffer);
  out.counts = gbuffer.counts;
  DebugStages stages;
  const gpu::Buffer* open = gbuffer.normal;  // the mean open direction; the normal where the estimator does not find it
  if (needs_ao(output) || frame.beauty) {
    const bool reduced = settings.resolution != Resolution::full;
    const GBuffer work = reduced ? downsample(gpu, gbuffer, frame, settings) : gbuffer;
    auto [ao, bent, listed, error, squares] = estimate(gpu, work, frame, settings, needs_bent(settings, output));
    out.tiles = listed.counts;
    out.error = wants(output, &FrameOutputs::error) ? error : nullptr;
    out.squares = squares;
    const bool several = !settings.further_radii.empty(), each = several && wants(output, &FrameOutputs::scales);
    if (each) out.scales = ao;
    out.ao = several ? &combine(gpu, work, *ao) : ao;
    stages = {work, out.ao, out.ao, listed.sectors};
    const FilterRuns runs = several ? FilterRuns{} : dilate(gpu, work, listed, frame, settings);
    if (settings.denoise != Denoise::none && settings.tolerance == 0) {
      stages.denoised_ao = out.ao = &denoise(gpu, work, *out.ao, frame, settings, "", runs);
      if (each) out.scales = &denoise(gpu, work, *out.scales, frame, settings, "scales ");
      if (bent) bent = &denoise(gpu, work, *bent, frame, settings, "bent ");
    }
    if (reduced) {
      out.ao = &upsample(gpu, gbuffer, work, *out.ao, frame, settings, "", runs);
      if (each) out.scales = &upsample(gpu, gbuffer, work, *out.scales, frame, settings, "scales ");
      if (bent) bent = &upsample(gpu, gbuffer, work, *bent, frame, settings, "bent ");
    }
    if (wants(output, &FrameOutputs::confidence)) out.confidence = &confidence(gpu, gbuffer, frame, settings);
    if (bent) open = &bent_normal(gpu, gbuffer, *bent);
    if (shapes(settings) || frame.material_ao) {
      out.ao = &shape(gpu, gbuffer, *out.ao, frame, settings);
      if (each) out.scales = &shape(gpu, gbuffer, *out.scales, frame, settings, "scales ");
    }
    if (!several && wants(output, &FrameOutputs::scales)) out.scales = out.ao;
  }
  if (wants(output, &FrameOutputs::specular_occlusion))
    out.specular_occlusion = &specular_occlusion(gpu, gbuffer, *open, *out.ao, settings);
  if (output.multi_bounce) out.color_ao = &multi_bounce(gpu, gbuffer, *out.ao, frame);
  if (frame.beauty) out.composite = &composite(gpu, gbuffer, out.color_ao ? *out.color_ao : *out.ao, frame, output);
  if (wants(output, &FrameOutputs::normal))
    out.normal = &directions(gpu, gbuffer, *gbuffer.normal, "normal planes", frame);
  if (wants(output, &FrameOutputs::bent_normal))
    out.bent_normal = &directions(gpu, gbuffer, *open, "bent normal planes", frame);
  if (wants(output, &FrameOutputs::depth)) out.depth = gbuffer.depth;
  for (const auto* view : debug_views_of(output))
    out.debug.push_back(debug(gpu, *view, gbuffer, stages, frame, settings));

  for (const auto* result :
       {out.counts, out.tiles, out.error, out.squares, out.confidence, out.ao, out.scales, out.color_ao, out.composite,
        out.normal, out.bent_normal, out.depth, out.specular_occlusion})
    if (result) gpu.download(*result);
  for (const auto& plane : out.debug) gpu.download(*plane.values);
  return out;
}

bool needs_ao(const OutputSettings& output) {
  for (const auto* view : debug_views_of(output))
    if (view->source == DebugSource::raw_ao || view->source == DebugSource::denoised_ao ||
        view->source == DebugSource::tiles)
      return true;
  return output.multi_bounce || wants(output, &FrameOutputs::error) || wants(output, &FrameOutputs::confidence) ||
         !output.composite.empty() || !output.preview.empty() || wants(output, &FrameOutputs::ao) ||
         wants(output, &FrameOutputs::scales) || wants(output, &FrameOutputs::bent_normal) ||
         wants(output, &FrameOutputs::specular_occlusion);
}

bool needs_bent(const EstimatorSettings& settings, const OutputSettings& output) {
  return has_bent_normals(settings) &&
         (wants(output, &FrameOutputs::bent_normal) || wants(output, &FrameOutputs::specular_occlusion));
}

}  // namespace alcove
