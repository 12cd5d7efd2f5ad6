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

std::vector<Vec3> first_band(std::span<const float> transfer) {
  const std::size_t pixels = transfer.size() / 9;
  const double constant = std::sqrt(3 / std::numbers::pi) / 2;
  std::vector<Vec3> vectors(pixels);
  for (std::size_t i = 0; i < pixels; i++)
    vectors[i] = 1 / constant * Vec3{transfer[i + 3 * pixels], transfer[i + pixels], transfer[i + 2 * pixels]};
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
  const Estimate result = estimate(gpu, gbuffer, sites(gpu, gbuffer, site_rule_of(settings)), inputs, settings, 1);
  gpu.download(*result.moments);
  gpu.run();
  std::vector<Vec3> vectors = vectors_in(result.moments->as<float>(), 2, -1);  // less what is blocked
  const std::vector<Vec3> normals = vectors_in(frame.normal);
  for (std::size_t i = 0; i < vectors.size(); i++)
    if (frame.depth[i] < frame.sky) vectors[i] = vectors[i] + 2.0 / 3 * unit(normals[i]);
  return vectors;
}

}  // namespace alcove::test
