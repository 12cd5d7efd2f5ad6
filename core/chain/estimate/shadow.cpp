// Host side of shadow.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/filters/filters.h"
#include "core/chain/results/results.h"

namespace alcove {
namespace {

constexpr double kAnywhere = 1e20;  // scene units: a reach that nothing bounds

// Of a light of some size.
constexpr uint kLeastDirections = 2, kDirectionsExact = 16;

bool is_hard(const Light& light) { return !(float(light.size) > 0); }

/// A sun up to this diameter, in degrees, has penumbrae of few pixels, which a filter would widen.
constexpr double kSharpSun = 1;

bool is_filtered(const Light& light) { return !is_hard(light) && (light.is_lamp || light.size > kSharpSun); }

/// A plane before all surfaces of every block, and their farthest depth.
const gpu::Buffer& nearest(gpu::Recorder& gpu, const GBuffer& occluders, const std::string& name) {
  const auto blocks = [](int side) { return std::size_t((side + kNearestStep - 1) / kNearestStep); };
  const ivec2 size = occluders.view.size;
  const gpu::Buffer& result = gpu.buffer(name, blocks(size.x) * blocks(size.y) * 4 * sizeof(float));
  gpu.dispatch("nearest", NearestParams{size, occluders.view.orthographic},
               {{"Occluders", occluder_depth_of(occluders)}, {"Nearest", result}},
               {uint(blocks(size.x)), uint(blocks(size.y))});
  return result;
}

}  // namespace

gpu::Buffer& shadow(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                    const EstimatorSettings& settings, const gpu::Buffer* told, bool with_confidence) {
  if (frame.lights.empty()) throw std::logic_error("there are shadows without lights");
  EstimatorSettings sampled = bracket_of(settings);
  sampled.stride = 1;  // every pixel has a shadow of its own
  const Reach reach = reach_of(sampled, radii_of(settings).back());
  const Sampling sampling = sampling_of(sampled, frame.frame);
  const GBuffer counted = occluders(gpu, gbuffer, frame);
  if (!told && tells_backs(sampled)) told = &backs(gpu, counted, reach, frame[RawPlane::normal] != nullptr).words;
  // Of the visibility, and of the two that bracket it for the confidence: the thinnest occluders, then the thickest.
  struct Rule {
    GBuffer counted;
    Reach reach;
    const gpu::Buffer *told, *nearest;
  };
  std::vector<Rule> rules{{counted, reach, told, &nearest(gpu, counted, "nearest")}};
  if (with_confidence) {
    Reach thin = reach, thick = reach;
    thin.thickness = float(kThin * reach.radius);
    thin.complete = Completion::none;
    thick.thickness = kMostBack * reach.radius;
    const GBuffer most = occluders(gpu, gbuffer, frame, Unknown::blocked);
    rules.push_back({counted, thin, nullptr, rules.front().nearest});
    rules.push_back({most, thick, nullptr, &nearest(gpu, most, "bracket nearest")});
  }
  ShadowParams params{};
  params.view = gbuffer.view;
  params.reach = float(settings.shadow_reach.value_or(kAnywhere));
  params.size = reach.radius;
  params.bias = settings.estimator == Estimator::crytek ? 0 : reach.bias;
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.depth_precision = gbuffer.depth_precision;
  const std::size_t count = frame.lights.size();
  const auto dispatch = [&](const Light& light, std::size_t i, std::size_t rule, const gpu::Buffer& result) {
    const auto& [of_rule, blocks, backs, nearest] = rules[rule];
    params.light = to_vec3(light.at);
    params.is_lamp = light.is_lamp ? 1 : 0;
    params.spread = float(light.is_lamp ? light.size : std::tan(light.size * std::numbers::pi / 360));
    params.thickness = blocks.thickness;
    params.plane = uint(rule == 0 ? i : count + i);
    std::vector<gpu::Binding> buffers{
        {"Depth", gbuffer.depth}, {"Normal", gbuffer.normal},      {"Occluders", occluder_depth_of(of_rule)},
        {"Nearest", nearest},     {"Backs", gpu::Optional(backs)}, {"Result", result}};
    if (gbuffer.surfaces > 1) buffers.push_back({"Hidden", occluder_hidden_of(of_rule)});
    const uint solid = solid_of(blocks, backs != nullptr) | kHiddenSurface * (gbuffer.surfaces - 1);
    const uint directions = is_hard(light)               ? 1
                            : searches_exactly(settings) ? kDirectionsExact
                                                         : std::max(uint(settings.slices), kLeastDirections);
    const std::vector<uint> constants{solid, directions, rule == 2 ? 1u : 0u};
    gpu.dispatch(gbuffer.surfaces == 1 ? "shadow" : "shadow_layers", params, buffers, extent_of(gbuffer.view),
                 constants);
  };
  const auto estimate = [&](bool filtered, const gpu::Buffer& result) {
    for (std::size_t i = 0; i < count; i++)
      for (std::size_t rule = 0; is_filtered(frame.lights[i]) == filtered && rule < rules.size(); rule++)
        dispatch(frame.lights[i], i, rule, result);
  };
  // Hard lights have no noise, and sharp ones little. They take their planes behind the filter.
  gpu::Buffer* result = &gpu.buffer("shadow", (with_confidence ? 2 : 1) * count * plane_bytes(gbuffer.view));
  if (std::ranges::any_of(frame.lights, is_filtered)) {
    estimate(true, *result);
    result = &denoise(gpu, gbuffer, *result, denoiser_of(sampled), "shadow ");
  }
  estimate(false, *result);
  return *result;
}

}  // namespace alcove
