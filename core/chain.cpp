// The order of the passes: one line each, and nothing else.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain.h"

namespace alcove {

FrameOutputs run_chain(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings) {
  FrameOutputs out;
  for (const auto* plane : {frame.depth, frame.normal, frame.beauty, frame.indirect, frame.diffuse_color})
    if (plane) gpu.upload(*plane);

  const GBuffer gbuffer = prepare(gpu, frame);
  out.counts = gbuffer.counts;
  const bool reduced = settings.resolution != Resolution::full;
  const GBuffer work = reduced ? downsample(gpu, gbuffer, frame, settings) : gbuffer;
  out.ao = &estimate(gpu, work, frame, settings);
  if (settings.denoise != Denoise::none) out.ao = &denoise(gpu, work, *out.ao, settings);
  if (reduced) out.ao = &upsample(gpu, gbuffer, work, *out.ao, frame, settings);
  if (settings.intensity != 1 || settings.power != 1) out.ao = &shape(gpu, *out.ao, gbuffer.view, settings);
  if (frame.beauty) out.composite = &composite(gpu, gbuffer, *out.ao, frame);

  for (const auto* result : {out.counts, out.ao, out.composite})
    if (result) gpu.download(*result);
  return out;
}

}  // namespace alcove
