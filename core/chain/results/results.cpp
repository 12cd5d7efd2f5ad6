// Host side of the kernels of kernels/results/ but debug.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/results.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/filters/filters.h"
#include "kernels/results/results.h"

namespace alcove {
namespace {

/// Whether an AOV is filtered. The depths of first and of hidden surfaces are not.
bool is_filtered(const AovRow& row) {
  return row.planes != &FrameOutputs::depth && row.planes != &FrameOutputs::hidden;
}

/// At a distance from the middle, in widths of the filter: at most 1/2.
double weight_at(PixelFilterKind kind, double distance) {
  switch (kind) {
    case PixelFilterKind::box: return 1;
    case PixelFilterKind::gaussian: return std::exp(-8 * distance * distance);
    case PixelFilterKind::blackman_harris: {
      const double angle = 2 * std::numbers::pi * (distance + 0.5);
      return 0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) - 0.01168 * std::cos(3 * angle);
    }
  }
  return 0;
}

/// The distance of a pixel from its block's middle, in widths of the filter. `pixel` counts along the block's row.
double distance_of(int pixel, double width, int factor) { return ((pixel + 0.5) / factor - 0.5) / width; }

/// The weights, along an axis, of a block's `factor` pixels and of as many pixels to its left as to its right, from the
/// left on. They need not add up to 1.
struct FilterWeights {
  int first = 0;  // px from the block's first pixel, at most 0
  std::vector<float> weights;
};

/// `filter`: its width in pixels of the smaller picture. Box: all the same; Gaussian: exp(-2 (2 x / width)^2), as
/// RenderMan and Arnold have it; Blackman-Harris: the window of four terms (Harris, On the Use of Windows for Harmonic
/// Analysis with the Discrete Fourier Transform, 1978), as Cycles has it. A pixel counts by its centre.
FilterWeights filter_weights(const PixelFilter& filter, int factor) {
  const double width = filter.width.value_or(usual_width(filter.kind));
  FilterWeights result;
  while (std::abs(distance_of(result.first - 1, width, factor)) <= 0.5) result.first--;
  for (int pixel = result.first; pixel < factor - result.first; pixel++)
    result.weights.push_back(float(weight_at(filter.kind, distance_of(pixel, width, factor))));
  return result;
}

}  // namespace

gpu::Buffer& shape(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const EstimatorSettings& settings,
                   const gpu::Buffer* material_ao, const Matte& matte, const std::string& prefix) {
  gpu::Buffer& shaped = gpu.buffer(prefix + "shaped", planes.bytes());
  ShapeParams params{};
  params.size = gbuffer.view.size;
  params.intensity = float(settings.intensity);
  params.power = float(settings.power);
  params.fade_start = float(settings.fade_start.value_or(0));
  params.fade_end = float(settings.fade_end.value_or(0));
  params.least = float(settings.least);
  params.outside = float(matte.outside);
  params.planes = planes_in(planes, gbuffer.view);
  const uint mode = (settings.intensity != 1 ? kShapeByIntensity : 0) | (settings.power != 1 ? kShapeByPower : 0) |
                    (settings.fade_end ? kShapeByFade : 0) | (material_ao ? kShapeByMaterial : 0) |
                    (settings.least > 0 ? kShapeByLeast : 0) | (matte.plane ? kShapeByMatte : 0) |
                    (material_ao && prefix.empty() ? kShapeCountsRepaired : 0);
  gpu.dispatch("shape", params,
               {{"Ao", planes},
                {"Shaped", shaped},
                {"Depth", gbuffer.depth},
                {"Material", gpu::Optional(material_ao)},
                {"Matte", gpu::Optional(matte.plane)},
                {"Counts", gbuffer.counts}},
               extent_of(gbuffer.view), {mode});
  return shaped;
}

Visibility shape(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility,
                 const EstimatorSettings& settings, const gpu::Buffer* material_ao, const Matte& matte) {
  const bool changes = settings.intensity != 1 || settings.power != 1 || settings.fade_end || material_ao ||
                       settings.least > 0 || matte.plane;
  if (!visibility.ao || !changes) return visibility;
  Visibility result = visibility;
  result.ao = &shape(gpu, gbuffer, *visibility.ao, settings, material_ao, matte);
  if (visibility.scales)
    result.scales = &shape(gpu, gbuffer, *visibility.scales, settings, material_ao, matte, kScalesPrefix);
  return result;
}

gpu::Buffer& bent_normal(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer* moments) {
  if (!moments) return *gbuffer.normal;
  gpu::Buffer& result = gpu.buffer("bent normal", plane_bytes(gbuffer.view));
  gpu.dispatch("bent_normal", BentNormalParams{gbuffer.view.size},
               {{"Normal", gbuffer.normal}, {"Moments", moments}, {"Result", result}}, extent_of(gbuffer.view));
  return result;
}

gpu::Buffer& transfer(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility,
                      const Matrix3& space_from_view, const std::string& name, const Environment* light) {
  gpu::Buffer& planes = gpu.buffer(name, (light ? 3 : 9) * plane_bytes(gbuffer.view));
  gpu::Buffer* colors =
      light ? &gpu.buffer("environment", light->light.size() * sizeof(vec3), gpu::Use::upload) : nullptr;
  if (light) std::ranges::transform(light->light, colors->as<vec3>().begin(), to_vec3);
  const gpu::Buffer* ao = visibility.scales ? visibility.scales : visibility.ao;
  const TransferParams params{gbuffer.view.size, ao ? planes_in(*ao, gbuffer.view) - 1 : 0, to_vec3(space_from_view[0]),
                              to_vec3(space_from_view[1]), to_vec3(space_from_view[2])};
  gpu.dispatch("transfer", params,
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Ao", gpu::Optional(ao)},
                {"Moments", gpu::Optional(visibility.moments)},
                {"Light", gpu::Optional(colors)},
                {"Planes", planes}},
               extent_of(gbuffer.view), {visibility.moments ? 0u : 1u, light ? 1u : 0u});
  return planes;
}

FrameOutputs curvature(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, std::size_t radii,
                       const Wanted& wanted, const Matte& matte, FrameOutputs out) {
  if (!wanted.needs_curvature()) return out;
  const auto planes = [&](gpu::Buffer* FrameOutputs::*member, const char* name) {
    return wanted.has(member) ? &gpu.buffer(name, planes_of_curvature(radii) * plane_bytes(gbuffer.view)) : nullptr;
  };
  out.convexity = planes(&FrameOutputs::convexity, "convexity");
  out.cavity = planes(&FrameOutputs::cavity, "cavity");
  out.curvature = planes(&FrameOutputs::curvature, "curvature");
  const uint mode = (out.convexity ? kCurvatureConvexity : 0) | (out.cavity ? kCurvatureCavity : 0) |
                    (out.curvature ? kCurvatureBoth : 0) | (matte.plane ? kCurvatureByMatte : 0);
  gpu.dispatch("curvature",
               CurvatureParams{gbuffer.view.size, planes_in(*visibility.moments, gbuffer.view) - 2 * uint(radii)},
               {{"Open", visibility.moments},
                {"Matte", gpu::Optional(matte.plane)},
                {"Convexity", gpu::Optional(out.convexity)},
                {"Cavity", gpu::Optional(out.cavity)},
                {"Curvature", gpu::Optional(out.curvature)}},
               extent_of(gbuffer.view), {mode, uint(radii)});
  return out;
}

gpu::Buffer& directions(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& packed, const std::string& name,
                        const Matrix3& aov_from_view) {
  gpu::Buffer& planes = gpu.buffer(name, 3 * plane_bytes(gbuffer.view));
  const DirectionsParams params{gbuffer.view.size, to_vec3(aov_from_view[0]), to_vec3(aov_from_view[1]),
                                to_vec3(aov_from_view[2])};
  gpu.dispatch("directions", params, {{"Depth", gbuffer.depth}, {"Packed", packed}, {"Planes", planes}},
               extent_of(gbuffer.view));
  return planes;
}

gpu::Buffer& specular_occlusion(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& open,
                                const gpu::Buffer& ao, double roughness) {
  gpu::Buffer& result = gpu.buffer("specular occlusion", plane_bytes(gbuffer.view));
  gpu.dispatch("specular_occlusion", SpecularOcclusionParams{gbuffer.view, float(roughness)},
               {{"Depth", gbuffer.depth}, {"Normal", gbuffer.normal}, {"Bent", open}, {"Ao", ao}, {"Result", result}},
               extent_of(gbuffer.view));
  return result;
}

gpu::Buffer& multi_bounce(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame) {
  const gpu::Buffer* albedo = frame[RawPlane::albedo];
  gpu::Buffer& result = gpu.buffer("color ao", 3 * plane_bytes(gbuffer.view));
  gpu.dispatch("multi_bounce", MultiBounceParams{gbuffer.view.size, albedo ? 1u : 0u, float(frame.albedo_value)},
               {{"Ao", ao}, {"Albedo", gpu::Optional(albedo)}, {"Result", result}}, extent_of(gbuffer.view));
  return result;
}

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

int reduce_reach(const PixelFilter& filter, int factor) {
  return factor == 1 ? 0 : factor - filter_weights(filter, factor).first;
}

FrameOutputs reduce(gpu::Recorder& gpu, const FrameInputs& frame, const PixelFilter& filter, const FrameOutputs& out) {
  const int factor = frame.supersampling;
  if (factor == 1) return out;
  const FilterWeights along = filter_weights(filter, factor);
  gpu::Buffer& weights = gpu.buffer("filter weights", along.weights.size() * sizeof(float), gpu::Use::upload);
  std::ranges::copy(along.weights, weights.as<float>().begin());
  const auto within = [&](int place) { return (place % factor + factor) % factor; };
  ReduceParams params{};
  params.size = frame.view.size;
  params.offset = {within(frame.noise_origin.x), within(frame.noise_origin.y)};
  params.factor = factor;
  params.first = along.first;
  params.count = int(along.weights.size());
  FrameOutputs reduced = out;
  const auto filter_planes = [&](gpu::Buffer* FrameOutputs::*planes, const std::string& name) {
    if (!(out.*planes)) return;
    gpu::Buffer& result = gpu.buffer("reduced " + name, (out.*planes)->bytes());
    params.planes = planes_in(result, frame.view);
    gpu.dispatch("reduce", params, {{"Planes", out.*planes}, {"Weights", weights}, {"Result", result}},
                 {groups_of(params.size.x + params.offset.x, uint(factor)),
                  groups_of(params.size.y + params.offset.y, uint(factor))});
    reduced.*planes = &result;
  };
  for (const auto& row : kAovs)
    if (is_filtered(row)) filter_planes(row.planes, row.name);
  filter_planes(&FrameOutputs::color_ao, "color ao");
  return reduced;
}

gpu::Buffer* composite(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer* ao, const gpu::Buffer* shadow,
                       const FrameInputs& frame, const CompositeLook& look, double least) {
  if (!frame[RawPlane::beauty]) return nullptr;
  const gpu::Buffer& beauty = *frame[RawPlane::beauty];
  const gpu::Buffer* light = frame[RawPlane::indirect];
  const gpu::Buffer* color = frame[RawPlane::diffuse_color];
  gpu::Buffer& result = gpu.buffer("composite", beauty.bytes());
  gpu::Buffer& lights = gpu.buffer(
      "ambient lights", std::max<std::size_t>(1, frame.ambient.size()) * sizeof(AmbientLight), gpu::Use::upload);
  std::ranges::transform(frame.ambient, lights.as<AmbientLight>().begin(), [&](const AmbientReading& reading) {
    const auto from = std::ranges::find(frame.lights, reading.shadow, &Light::name);
    return AmbientLight{float(reading.weight.value_or(0)), reading.color,
                        from == frame.lights.end() ? -1 : int(from - frame.lights.begin())};
  });
  CompositeParams params{};
  params.view = frame.view;
  params.has_alpha = planes_in(beauty, frame.view) == 4 ? 1 : 0;
  params.lights = light ? uint(frame.ambient.size()) : 0;
  params.dims_beauty = dims_beauty(frame.ambient) ? 1 : 0;
  params.has_color = planes_in(*ao, frame.view) == 3 ? 1 : 0;
  params.fog_density = float(look.fog_density);
  params.gain = float(look.gain);
  params.least = float(least);
  params.mix = float(look.mix);
  params.tint = to_vec3(look.tint);
  gpu.dispatch("composite", params,
               {{"Ao", ao},
                {"Beauty", beauty},
                {"Light", gpu::Optional(light)},
                {"Color", gpu::Optional(color)},
                {"Lights", lights},
                {"Shadow", gpu::Optional(shadow)},
                {"Result", result},
                {"Counts", gbuffer.counts},
                {"Depth", gbuffer.depth}},
               extent_of(frame.view));
  return &result;
}

}  // namespace alcove
