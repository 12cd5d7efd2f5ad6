// The order of the passes: one line each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/chain.h"

#include "core/base/estimator_facts.h"
#include "core/chain/estimate/completion.h"
#include "core/chain/geometry/margin.h"
#include "core/chain/geometry/matte.h"
#include "core/chain/geometry/occluders.h"
#include "core/chain/hidden/hidden.h"
#include "core/chain/hidden/warp.h"
#include "core/chain/open_sky.h"
#include "core/chain/results/confidence.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/reduce.h"
#include "core/chain/results/shading.h"
#include "core/chain/time/accumulate.h"

namespace alcove {
namespace {

FrameOutputs downloaded(gpu::Recorder& gpu, const FrameOutputs& out) {
  for (const auto* result : {out.counts, out.layer_counts, out.view_counts, out.tiles, out.sites, out.squares,
                             out.completion, out.count, out.color_ao, out.composite})
    if (result) gpu.download(*result);
  for (const auto& row : kAovs)
    if (out.*row.planes) gpu.download(*(out.*row.planes));
  for (const auto& plane : out.debug) gpu.download(*plane.values);
  return out;
}

/// The planes of radii that a visibility has beside their mean.
std::size_t scales_of(const EstimatorSettings& settings, const Wanted& wanted) {
  const std::size_t radii = radii_of(settings).size();
  return wanted.has(&FrameOutputs::scales) && radii > 1 ? radii : 0;
}

/// Downloads what the frame hands to others.
FrameOutputs handed_out(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, FrameOutputs out) {
  out.own = OwnEstimate{gbuffer, visibility};
  for (const auto* part : {gbuffer.depth, gbuffer.normal, visibility.ao, visibility.scales, visibility.bent})
    if (part) gpu.download(*part);
  return downloaded(gpu, out);
}

}  // namespace

FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings,
                       const Wanted& wanted) {
  if (is_open_sky(frame, settings, wanted)) return open_sky(gpu, frame, settings);
  upload(gpu, frame);

  const Layering layering = layering_of(settings);
  const FrameInputs inputs = with_margin(frame);
  const GBuffer prepared = prepare(gpu, frame);
  reconstruct(gpu, prepared);
  const GBuffer warped = warp(gpu, prepared, frame, layering);
  const GBuffer wide = layers(gpu, warped, frame, layering);
  const GBuffer gbuffer = cut(gpu, frame, wide, prepared);
  FrameOutputs out;
  out.counts = gbuffer.counts;
  out.layer_counts = gbuffer.layer_counts;
  out.view_counts = wide.view_counts;
  Visibility visibility;
  const gpu::Buffer* open_directions = gbuffer.normal;
  DebugStages stages;
  if (wanted.visibility || frame[RawPlane::beauty]) {
    const Matte wanted_at = matte(gpu, frame);
    const bool with_bent = needs_bent(settings, wanted);
    Visibility whole;
    if (!frame.estimates.values) {
      const GBuffer counted = occluders(gpu, wide, frame);
      const GBuffer blocks = downsample(gpu, counted, block_grid(inputs, int(settings.resolution)));
      const GBuffer work = needed(gpu, blocks, inputs, wanted_at, filter_reach_of(settings));
      const bool with_completed = wanted.completed && completes_anywhere(settings);
      const Sites chosen = sites(gpu, work, site_rule_of(settings, frame.turn));
      const Estimate estimated = estimate(gpu, work, chosen, inputs, settings, with_bent, with_completed);
      const Denoiser denoiser = denoiser_of(settings);
      out.completion = completion(gpu, work, estimated, chosen);
      const Visibility noisy = combine(gpu, work, estimated, wanted.has(&FrameOutputs::scales));
      const FilterRuns runs = dilate(gpu, work, estimated.listed, denoiser);
      const Visibility smooth = chosen.rows ? interpolate(gpu, work, noisy, chosen, denoiser, runs)
                                            : denoise(gpu, work, noisy, denoiser, runs);
      whole = cut(gpu, frame, upsample(gpu, wide, work, smooth, runs));
      stages = {work, noisy.ao, chosen, smooth.ao, estimated.completed, estimated.listed.kinds};
      out.tiles = estimated.listed.counts;
      out.sites = estimated.listed.site_counts;
      out.squares = estimated.squares;
      out.completed = estimated.completed;
      if (wanted.has(&FrameOutputs::error)) out.error = cut(gpu, frame, estimated.error, "error");
    } else {
      const std::size_t scales = scales_of(settings, wanted);
      const Accumulation mean = accumulate(gpu, gbuffer, frame.estimates, settings, scales, with_bent);
      whole = mean.visibility;
      stages.count = mean.count;
      out.count = mean.count;
    }
    if (wanted.only_own) return handed_out(gpu, gbuffer, whole, out);
    open_directions = &bent_normal(gpu, gbuffer, whole.bent);
    visibility = shape(gpu, gbuffer, whole, shaping_of(settings), frame[RawPlane::material_ao], wanted_at);
  }

  out.ao = visibility.ao;
  if (wanted.has(&FrameOutputs::scales)) out.scales = visibility.scales ? visibility.scales : visibility.ao;
  if (wanted.has(&FrameOutputs::normal))
    out.normal = &directions(gpu, gbuffer, *gbuffer.normal, "normal planes", frame.aov_from_view);
  if (wanted.has(&FrameOutputs::bent_normal))
    out.bent_normal = &directions(gpu, gbuffer, *open_directions, "bent normal planes", frame.aov_from_view);
  if (wanted.has(&FrameOutputs::depth)) out.depth = gbuffer.depth;
  if (wanted.has(&FrameOutputs::hidden)) out.hidden = &hidden_planes(gpu, gbuffer, layering);
  if (wanted.has(&FrameOutputs::confidence))
    out.confidence = cut(gpu, frame, &confidence(gpu, wide, inputs, settings), "confidence");
  if (wanted.has(&FrameOutputs::specular_occlusion))
    out.specular_occlusion = &specular_occlusion(gpu, gbuffer, *open_directions, *visibility.ao, settings.roughness);
  if (wanted.multi_bounce) out.color_ao = &multi_bounce(gpu, gbuffer, *visibility.ao, frame);
  out = reduce(gpu, frame, wanted.filter, out);
  if (frame[RawPlane::beauty])
    out.composite = &composite(gpu, gbuffer, *(out.color_ao ? out.color_ao : out.ao), frame, wanted.look);
  for (const auto* view : wanted.debug_views) out.debug.push_back(debug(gpu, *view, gbuffer, stages, frame));
  return downloaded(gpu, out);
}

}  // namespace alcove
