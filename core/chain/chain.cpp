// The order of the passes: one line each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/chain.h"

#include <vector>

#include "core/chain/filters/filters.h"
#include "core/chain/hidden/hidden.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/results.h"
#include "core/chain/time/accumulate.h"

namespace alcove {
namespace {

/// All surfaces of the frame, with unit normals that face the eye.
Surfaces surfaces_of(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings) {
  const Layering layering = layering_of(settings);
  const GBuffer prepared = prepare(gpu, frame);
  reconstruct(gpu, prepared);
  const GBuffer warped = warp(gpu, prepared, frame, layering);
  const GBuffer wide = layers(gpu, warped, frame, layering);
  return {cut(gpu, frame, wide, prepared), wide};
}

/// What is to be estimated: all of the frame, or what its matte needs.
GBuffer work_of(gpu::Recorder& gpu, const FrameInputs& frame, const FrameInputs& inputs, const Surfaces& surfaces,
                const EstimatorSettings& settings, Matte& masked) {
  masked = matte(gpu, frame);
  const GBuffer counted = occluders(gpu, surfaces.wide, frame);
  const GBuffer blocks = downsample(gpu, counted, block_grid(inputs, int(settings.resolution)));
  return needed(gpu, blocks, inputs, masked, filter_reach_of(settings));
}

/// The frame's own estimate, smoothed.
FrameVisibility own_visibility(gpu::Recorder& gpu, const FrameInputs& frame, const Surfaces& surfaces,
                               const EstimatorSettings& settings, const Wanted& wanted) {
  const FrameInputs inputs = with_margin(frame);
  FrameVisibility visible;
  const GBuffer work = work_of(gpu, frame, inputs, surfaces, settings, visible.matte);
  const uint order = moment_order(settings, wanted);
  const bool with_completed = wanted.completed && completes_anywhere(settings);
  visible.is_quick = searches_quickly(settings, work, order, wanted.needs_curvature());
  const gpu::Buffer* wide = visible.is_quick ? &margin(gpu, work) : nullptr;
  const Sites chosen = sites(gpu, work, site_rule_of(settings, frame.turn), "", wide);
  visible.estimate =
      visible.is_quick ? quick_horizon(gpu, work, chosen, *wide, inputs, settings)
                       : estimate(gpu, work, chosen, inputs, settings, order, with_completed, wanted.needs_curvature());
  if (settings.resolution != Resolution::full) visible.estimate.told = nullptr;  // which is that of blocks
  visible.completion = completion(gpu, work, visible.estimate, chosen);
  const Denoiser denoiser = denoiser_of(settings);
  const Visibility noisy{visible.estimate.ao, nullptr, visible.estimate.moments};
  const Visibility of_radii = smooth(gpu, work, noisy, chosen, denoiser, order);
  const Visibility smoothed = combine(gpu, work, of_radii, wanted.needs_scales());
  visible.visibility = cut(gpu, frame, upsample(gpu, surfaces.wide, work, smoothed));
  if (wanted.has(&FrameOutputs::error)) visible.error = cut(gpu, frame, visible.estimate.error, "error");
  visible.stages = {work, noisy.ao, chosen, smoothed.ao, visible.estimate.completed, visible.estimate.listed.kinds};
  return visible;
}

/// The mean of what many frames have estimated.
FrameVisibility mean_visibility(gpu::Recorder& gpu, const FrameInputs& frame, const Surfaces& surfaces,
                                const EstimatorSettings& settings, const Wanted& wanted) {
  const std::size_t radii = radii_of(settings).size();
  const std::size_t scales = wanted.needs_scales() && radii > 1 ? radii : 0;
  FrameVisibility visible;
  visible.matte = matte(gpu, frame);
  const Accumulation mean = accumulate(gpu, surfaces.frame, frame.estimates, settings, scales,
                                       moment_order(settings, wanted), wanted.needs_curvature());
  visible.visibility = mean.visibility;
  visible.count = mean.count;
  visible.stages.count = mean.count;
  return visible;
}

FrameVisibility visibility_of(gpu::Recorder& gpu, const FrameInputs& frame, const Surfaces& surfaces,
                              const EstimatorSettings& settings, const Wanted& wanted) {
  if (!wanted.visibility && !frame[RawPlane::beauty]) return {};
  return frame.estimates.values ? mean_visibility(gpu, frame, surfaces, settings, wanted)
                                : own_visibility(gpu, frame, surfaces, settings, wanted);
}

/// The counts of the passes.
FrameOutputs counts_of(const FrameVisibility& visible) {
  const GBuffer& gbuffer = visible.surfaces.frame;
  return {.counts = gbuffer.counts,
          .layer_counts = gbuffer.layer_counts,
          .view_counts = gbuffer.view_counts,
          .tiles = visible.estimate.listed.counts,
          .sites = visible.estimate.listed.site_counts,
          .squares = visible.estimate.squares,
          .completion = visible.completion,
          .completed = visible.estimate.completed,
          .count = visible.count,
          .is_quick = visible.is_quick};
}

/// The estimate that the frame hands to others.
FrameOutputs handed_out(const FrameVisibility& visible) {
  FrameOutputs out = counts_of(visible);
  out.own = OwnEstimate{visible.surfaces.frame, visible.visibility};
  return out;
}

/// The outputs with the shadows of lights, the coefficients of the reflected light, and that light.
FrameOutputs with_light(gpu::Recorder& gpu, const FrameInputs& frame, const FrameVisibility& visible,
                        const EstimatorSettings& settings, const Wanted& wanted, FrameOutputs out) {
  const GBuffer& gbuffer = visible.surfaces.frame;
  const Visibility& visibility = visible.visibility;
  if (wanted.has(&FrameOutputs::shadow))
    out.shadow = cut(gpu, frame,
                     &shadow(gpu, visible.surfaces.wide, with_margin(frame), settings, visible.estimate.told,
                             wanted.has(&FrameOutputs::confidence)),
                     "shadow");
  if (wanted.has(&FrameOutputs::transfer))
    out.transfer = &transfer(gpu, gbuffer, visibility, frame.aov_from_view, "transfer");
  if (wanted.has(&FrameOutputs::relight))
    out.relight = &transfer(gpu, gbuffer, visibility, frame.world_from_view, "relight", &frame.environment);
  if (wanted.has(&FrameOutputs::relight_open))
    out.relight_open = &transfer(gpu, gbuffer, {}, frame.world_from_view, "relight open", &frame.environment);
  return out;
}

/// All that is wanted.
FrameOutputs shaped(gpu::Recorder& gpu, const FrameInputs& frame, const FrameVisibility& visible,
                    const EstimatorSettings& settings, const Wanted& wanted) {
  const GBuffer& gbuffer = visible.surfaces.frame;
  const bool has_open = moment_order(settings, wanted) > 0 &&
                        (wanted.has(&FrameOutputs::bent_normal) || wanted.has(&FrameOutputs::specular_occlusion));
  const gpu::Buffer& open = bent_normal(gpu, gbuffer, has_open ? visible.visibility.moments : nullptr);
  const Visibility visibility =
      shape(gpu, gbuffer, visible.visibility, settings, frame[RawPlane::material_ao], visible.matte);
  FrameOutputs out = with_light(gpu, frame, visible, settings, wanted, counts_of(visible));
  out = curvature(gpu, gbuffer, visible.visibility, 1 + settings.further_radii.size(), wanted, visible.matte, out);
  out.ao = visibility.ao;
  out.error = visible.error;
  if (wanted.has(&FrameOutputs::scales)) out.scales = visibility.scales ? visibility.scales : visibility.ao;
  if (wanted.has(&FrameOutputs::normal))
    out.normal = &directions(gpu, gbuffer, *gbuffer.normal, "normal planes", frame.aov_from_view);
  if (wanted.has(&FrameOutputs::bent_normal))
    out.bent_normal = &directions(gpu, gbuffer, open, "bent normal planes", frame.aov_from_view);
  if (wanted.has(&FrameOutputs::depth)) out.depth = gbuffer.depth;
  if (wanted.has(&FrameOutputs::hidden)) out.hidden = &hidden_planes(gpu, gbuffer, layering_of(settings));
  if (wanted.has(&FrameOutputs::confidence))
    out.confidence =
        cut(gpu, frame, &confidence(gpu, visible.surfaces.wide, with_margin(frame), settings), "confidence");
  if (wanted.has(&FrameOutputs::specular_occlusion))
    out.specular_occlusion = &specular_occlusion(gpu, gbuffer, open, *visibility.ao, settings.roughness);
  if (wanted.multi_bounce) out.color_ao = &multi_bounce(gpu, gbuffer, *visibility.ao, frame);
  out = reduce(gpu, frame, wanted.filter, out);
  const gpu::Buffer* ao = out.color_ao ? out.color_ao : out.ao;
  out.composite = composite(gpu, gbuffer, ao, out.shadow, frame, wanted.look, settings.least);
  for (const auto* view : wanted.debug_views) out.debug.push_back(debug(gpu, *view, gbuffer, visible.stages, frame));
  return out;
}

FrameOutputs downloaded(gpu::Recorder& gpu, const FrameOutputs& out) {
  std::vector<const gpu::Buffer*> results{out.counts,  out.layer_counts, out.view_counts, out.tiles,    out.sites,
                                          out.squares, out.completion,   out.count,       out.color_ao, out.composite};
  for (const auto& row : kAovs) results.push_back(out.*row.planes);
  for (const auto& plane : out.debug) results.push_back(plane.values);
  if (out.own)
    for (const auto* part : {out.own->gbuffer.depth, out.own->gbuffer.normal, out.own->visibility.ao,
                             out.own->visibility.scales, out.own->visibility.moments})
      results.push_back(part);
  for (const auto* result : results)
    if (result) gpu.download(*result);
  return out;
}

}  // namespace

FrameVisibility frame_visibility(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                                 const Wanted& wanted) {
  if (is_open_sky(frame, settings, wanted)) return {};
  const Surfaces surfaces = surfaces_of(gpu, frame, settings);
  FrameVisibility visible = visibility_of(gpu, frame, surfaces, settings, wanted);
  visible.surfaces = surfaces;
  return visible;
}

FrameOutputs results_of(gpu::Recorder& gpu, const FrameInputs& frame, const FrameVisibility& visible,
                        const EstimatorSettings& settings, const Wanted& wanted) {
  if (is_open_sky(frame, settings, wanted)) return open_sky(gpu, frame, settings);
  return downloaded(gpu, wanted.only_own ? handed_out(visible) : shaped(gpu, frame, visible, settings, wanted));
}

FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                       const Wanted& wanted) {
  return results_of(gpu, frame, frame_visibility(gpu, frame, settings, wanted), settings, wanted);
}

}  // namespace alcove
