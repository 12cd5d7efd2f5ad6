// Host side of shadow.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/chain/base/planes.h"
#include "core/chain/filters/filters.h"
#include "core/chain/geometry/matte.h"
#include "core/chain/results/confidence.h"

namespace alcove {
namespace {

constexpr double kAnywhere = 1e20;  // scene units: a reach that nothing bounds

// Of a light of some size.
constexpr uint kDirections = 4, kDirectionsExact = 16;

/// The nearest and the farthest depth of every block.
const gpu::Buffer& nearest(gpu::Recorder& gpu, const GBuffer& occluders) {
  const auto blocks = [](int side) { return std::size_t((side + kNearestStep - 1) / kNearestStep); };
  const ivec2 size = occluders.view.size;
  const gpu::Buffer& result = gpu.buffer("nearest", blocks(size.x) * blocks(size.y) * sizeof(vec2));
  gpu.dispatch("nearest", NearestParams{size}, {{"Occluders", occluder_depth_of(occluders)}, {"Nearest", result}},
               {uint(blocks(size.x)), uint(blocks(size.y))});
  return result;
}

}  // namespace

gpu::Buffer& shadow(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                    const EstimatorSettings& settings, const gpu::Buffer* told) {
  if (frame.lights.empty()) throw std::logic_error("there are shadows without lights");
  EstimatorSettings sampled = bracket_of(settings);
  sampled.stride = 1;  // every pixel has a shadow of its own
  const Reach reach = reach_of(sampled, radii_of(settings).back());
  const Sampling sampling = sampling_of(sampled, frame.frame);
  const GBuffer counted = occluders(gpu, gbuffer, frame);
  if (!told && tells_backs(sampled)) {
    const Chains links = chains(gpu, counted, reach, frame[RawPlane::normal] != nullptr);
    chain_ends(gpu, counted, links);
    told = &backs(gpu, counted, links);
  }
  ShadowParams params{};
  params.view = gbuffer.view;
  params.reach = float(settings.shadow_reach.value_or(kAnywhere));
  params.size = reach.radius;
  params.bias = settings.estimator == Estimator::crytek ? 0 : reach.bias;
  params.thickness = reach.thickness;
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.depth_precision = gbuffer.depth_precision;
  const std::size_t bytes = frame.lights.size() * plane_bytes(gbuffer.view);
  std::vector<gpu::Binding> buffers{{"Depth", gbuffer.depth},
                                    {"Normal", gbuffer.normal},
                                    {"Occluders", occluder_depth_of(counted)},
                                    {"Nearest", nearest(gpu, counted)},
                                    {"Backs", gpu::Optional(told)}};
  if (gbuffer.surfaces > 1) buffers.push_back({"Hidden", occluder_hidden_of(counted)});
  const uint solid = solid_of(reach, told != nullptr) | kHiddenSurface * (gbuffer.surfaces - 1);
  const bool exact = searches_exactly(settings);
  const auto estimate = [&](bool soft, const gpu::Buffer& result) {
    for (std::size_t i = 0; i < frame.lights.size(); i++) {
      const Light& light = frame.lights[i];
      if ((float(light.size) > 0) != soft) continue;
      params.light = to_vec3(light.at);
      params.is_lamp = light.is_lamp ? 1 : 0;
      params.spread = float(light.is_lamp ? light.size : std::tan(light.size * std::numbers::pi / 360));
      params.plane = uint(i);
      std::vector<gpu::Binding> all = buffers;
      all.push_back({"Result", result});
      const uint directions = !soft ? 1 : exact ? kDirectionsExact : kDirections;
      const std::vector<uint> constants{solid, directions};
      if (gbuffer.surfaces == 1)
        gpu.dispatch("shadow", params, all, extent_of(gbuffer.view), constants);
      else
        gpu.dispatch("shadow_layers", params, all, extent_of(gbuffer.view), constants);
    }
  };
  // Noise is of soft lights alone. So these are filtered, and hard ones take their planes behind the filter.
  gpu::Buffer* result = &gpu.buffer("shadow", bytes);
  if (std::ranges::any_of(frame.lights, [](const Light& light) { return float(light.size) > 0; })) {
    gpu.clear(*result);
    estimate(true, *result);
    result = &denoise(gpu, gbuffer, *result, denoiser_of(sampled), "shadow ");
  }
  estimate(false, *result);
  return *result;
}

}  // namespace alcove
