// Runs the chain, or the estimator alone, for bent normals.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/bent.h"

#include "core/chain/chain.h"
#include "core/chain/estimate/estimate.h"
#include "tests/support/device.h"

namespace alcove::test {

std::vector<Vec3> vectors_in(std::span<const float> planes, double scale, double offset) {
  const std::size_t pixels = planes.size() / 3;
  std::vector<Vec3> vectors(pixels);
  for (std::size_t i = 0; i < pixels; i++)
    vectors[i] = {scale * planes[i] + offset, scale * planes[i + pixels] + offset,
                  scale * planes[i + 2 * pixels] + offset};
  return vectors;
}

std::vector<Vec3> bent_normals(const HostFrame& frame, const EstimatorSettings& settings) {
  OutputSettings output;
  output.aovs = "bent-normal";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  recorder().run();
  return vectors_in(outputs.bent_normal->as<float>());
}

std::vector<Vec3> raw_bent(const HostFrame& frame, const EstimatorSettings& settings) {
  gpu::Recorder& gpu = recorder();
  const FrameInputs inputs = upload(gpu, frame);
  const GBuffer gbuffer = prepare(gpu, inputs);
  reconstruct(gpu, gbuffer);
  const Estimate result = estimate(gpu, gbuffer, sites(gpu, gbuffer, site_rule_of(settings)), inputs, settings, true);
  gpu.download(*result.bent);
  gpu.run();
  return vectors_in(result.bent->as<float>(), 2, -1);
}

}  // namespace alcove::test
