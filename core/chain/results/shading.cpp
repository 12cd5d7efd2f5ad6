// Host side of the kernels that make something of the visibility.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/shading.h"

#include <algorithm>

#include "core/chain/base/planes.h"
#include "kernels/results/results.h"

namespace alcove {

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
