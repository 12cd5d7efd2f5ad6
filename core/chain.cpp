// The order of the passes: one line each, and nothing else.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain.h"

#include "core/aov.h"

namespace alcove {

FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings, const OutputSettings& output) {
  FrameOutputs out;
  for (const auto* plane : {frame.depth, frame.normal, frame.beauty, frame.indirect, frame.diffuse_color, frame.material_ao, frame.albedo})
    if (plane) gpu.upload(*plane);

  const GBuffer gbuffer = prepare(gpu, frame, wants(output, &FrameOutputs::depth) ? gpu::Use::download : gpu::Use::device);
  reconstruct(gpu, gbuffer);
  out.counts = gbuffer.counts;
  DebugStages stages;
  if (needs_ao(output) || frame.beauty) {
    const bool reduced = settings.resolution != Resolution::full;
    const GBuffer work = reduced ? downsample(gpu, gbuffer, frame, settings) : gbuffer;
    out.ao = &estimate(gpu, work, frame, settings);
    stages = {work, out.ao, out.ao};
    if (settings.denoise != Denoise::none) stages.denoised_ao = out.ao = &denoise(gpu, work, *out.ao, frame, settings);
    if (reduced) out.ao = &upsample(gpu, gbuffer, work, *out.ao, frame, settings);
    if (shapes(settings) || frame.material_ao) out.ao = &shape(gpu, gbuffer, *out.ao, frame, settings);
  }
  if (wants(output, &FrameOutputs::specular_occlusion)) out.specular_occlusion = &specular_occlusion(gpu, gbuffer, *gbuffer.normal, *out.ao, settings);
  if (output.multi_bounce) out.color_ao = &multi_bounce(gpu, gbuffer, *out.ao, frame);
  if (frame.beauty) out.composite = &composite(gpu, gbuffer, out.color_ao ? *out.color_ao : *out.ao, frame, output);
  if (wants(output, &FrameOutputs::normal)) out.normal = &directions(gpu, gbuffer, *gbuffer.normal, "normal planes", frame);
  if (wants(output, &FrameOutputs::depth)) out.depth = gbuffer.depth;
  for (const auto* view : debug_views_of(output)) out.debug.push_back(debug(gpu, *view, gbuffer, stages, frame));

  for (const auto* result : {out.counts, out.ao, out.color_ao, out.composite, out.normal, out.depth, out.specular_occlusion})
    if (result) gpu.download(*result);
  for (const auto& plane : out.debug) gpu.download(*plane.values);
  return out;
}

double samples_per_pixel(const EstimatorSettings& settings) {
  const double factor = double(settings.resolution), samples = settings.estimator == Estimator::crytek ? settings.samples : 2 * settings.slices * settings.steps;
  return samples / (factor * factor * settings.stride);
}

bool needs_ao(const OutputSettings& output) {
  for (const auto* view : debug_views_of(output))
    if (view->source == DebugSource::raw_ao || view->source == DebugSource::denoised_ao) return true;
  return output.multi_bounce || !output.composite.empty() || !output.preview.empty() || wants(output, &FrameOutputs::ao) ||
         wants(output, &FrameOutputs::specular_occlusion);
}

}  // namespace alcove
