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
  out.ao = &estimate(gpu, gbuffer, frame, settings);
  if (settings.intensity != 1 || settings.power != 1) out.ao = &shape(gpu, *out.ao, gbuffer.view, settings);
  if (frame.beauty) out.composite = &composite(gpu, gbuffer, *out.ao, frame);

  for (const auto* result : {out.counts, out.ao, out.composite})
    if (result) gpu.download(*result);
  return out;
}

}  // namespace alcove
