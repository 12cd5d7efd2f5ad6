// The visibility with the thinnest and with the thickest occluders, and how far they are apart.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/confidence.h"

#include <limits>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/filters/filters.h"
#include "kernels/results/results.h"

namespace alcove {

EstimatorSettings bracket_of(const EstimatorSettings& settings) {
  EstimatorSettings bracket = settings;
  bracket.estimator = Estimator::gtao;
  bracket.search = SliceSearch::steps;
  bracket.tolerance = 0;
  bracket.resolution = Resolution::full;
  return bracket;
}

gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings) {
  const EstimatorSettings bracket = bracket_of(settings);
  const double radius = radii_of(settings).back();
  const Sampling sampling = sampling_of(bracket, frame.frame);
  Skipping skipping = skipping_of(bracket, frame, gbuffer.grid);
  const Denoiser denoiser = denoiser_of(bracket);
  const Sites chosen = sites(gpu, gbuffer, site_rule_of(bracket), "bracket ");
  skipping.bounds = bounds(gpu, gbuffer, skipping);
  const GBuffer least = occluders(gpu, gbuffer, frame), most = occluders(gpu, gbuffer, frame, Unknown::blocked);
  const auto visibility = [&](const GBuffer& counted, float thickness, Completion complete,
                              const std::string& prefix) -> const gpu::Buffer& {
    Reach reach = reach_of(bracket, radius);
    reach.thickness = thickness;
    reach.complete = complete;
    Estimate out{&gpu.buffer(prefix + "ao", plane_bytes(gbuffer.view))};
    out.listed = classify(gpu, gbuffer, skipping, reach, chosen, out, prefix);
    list_sites(gpu, gbuffer, chosen, out.listed, prefix);
    horizon(gpu, counted, reach, sampling, out);
    return smooth(gpu, gbuffer, *out.ao, chosen, denoiser, prefix);
  };
  const gpu::Buffer& thin = visibility(least, float(kThin * radius), Completion::none, "thin ");
  // Endless occluders block all that anything behind them does, but nothing beyond the border.
  const Completion beyond = completes_anywhere(settings) ? Completion::border : Completion::none;
  const gpu::Buffer& solid = visibility(most, std::numeric_limits<float>::infinity(), beyond, "solid ");
  // What is nearer than the sphere is no occluder, but may hide surfaces within it.
  const gpu::Buffer& completed =
      completes_anywhere(settings) ? visibility(least, float(kThin * radius), bracket.complete, "completed ") : thin;
  gpu::Buffer& result = gpu.buffer("confidence", plane_bytes(gbuffer.view));
  gpu.dispatch("confidence", ConfidenceParams{gbuffer.view, float(radius), gbuffer.depth_precision},
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Thin", thin},
                {"Solid", solid},
                {"Completed", completed},
                {"Result", result}},
               extent_of(gbuffer.view));
  return result;
}

}  // namespace alcove
