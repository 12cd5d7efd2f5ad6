// Host side of every kernel.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/passes.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "kernels/bitmask.h"
#include "kernels/composite.h"
#include "kernels/horizon.h"
#include "kernels/prepare.h"
#include "kernels/shape.h"

namespace alcove {
namespace {

std::size_t pixels_of(const View& view) { return std::size_t(view.size.x) * std::size_t(view.size.y); }
std::size_t plane_bytes(const View& view) { return pixels_of(view) * sizeof(float); }

/// As kernels take it: 0 says as deep as wide.
float thickness_of(const EstimatorSettings& settings) {
  if (settings.thickness == ThicknessKind::automatic) return 0;
  return settings.thickness == ThicknessKind::infinite ? std::numeric_limits<float>::infinity() : float(settings.thickness_length);
}

gpu::Extent extent_of(const View& view) { return {uint(view.size.x), uint(view.size.y)}; }
vec3 to_vec3(const std::array<double, 3>& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

uint normal_form_of(const FrameInputs& frame) {
  if (!frame.normal) return kNormalNone;
  if (frame.normal_encoding == NormalEncoding::octahedral) return kNormalOctahedral;
  if (frame.normal_encoding == NormalEncoding::spheremap) return kNormalSpheremap;
  return frame.normal->bytes() < 3 * plane_bytes(frame.view) ? kNormalXy : kNormalVector;
}

/// Where the noise pattern of a frame and seed begins: successive frames take successive points of the R2 sequence, seeds of another.
vec2 noise_shift(int frame, std::uint32_t seed) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  const auto shift = [&](double by_frame, double by_seed) { return float(fraction(0.5 + fraction(frame * by_frame) + fraction(seed * by_seed))); };
  return {shift(0.75487766624669276, 0.41421356237309505), shift(0.56984029099805327, 0.73205080756887729)};
}

/// Of the estimators that search slices.
template <class Params>
Params slice_parameters(const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings) {
  const double radius = settings.radius.value();
  Params params{};
  params.view = gbuffer.view;
  params.radius = float(radius);
  params.falloff_start = float(radius * settings.falloff_start);
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(frame.frame, settings.seed);
  params.thickness = thickness_of(settings);
  return params;
}
std::vector<uint> slice_constants(const EstimatorSettings& settings) { return {uint(settings.slices), uint(settings.steps), uint(settings.falloff)}; }

}  // namespace

GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame) {
  GBuffer gbuffer{frame.view, &gpu.buffer("depth", plane_bytes(frame.view), gpu::Use::device),
                  &gpu.buffer("normal", plane_bytes(frame.view), gpu::Use::device),
                  &gpu.buffer("counts", sizeof(FrameCounts), gpu::Use::download)};
  PrepareParams params{};
  params.view = frame.view;
  params.view_from_normal_x = to_vec3(frame.view_from_normal[0]);
  params.view_from_normal_y = to_vec3(frame.view_from_normal[1]);
  params.view_from_normal_z = to_vec3(frame.view_from_normal[2]);
  const DepthMap& map = frame.depth_map;
  params.depth_axis = to_vec3(map.axis);
  params.depth_form = map.form;
  params.along_ray = map.along_ray ? 1 : 0;
  params.origin = float(map.origin);
  params.base = float(map.base);
  params.slope = float(map.slope);
  params.sky_below = float(map.sky_below);
  params.sky_above = float(map.sky_above);
  params.sky_depth = float(map.sky_depth);
  params.normal_form = normal_form_of(frame);
  params.normal_unorm = frame.normal_unorm ? 1 : 0;
  gpu.clear(*gbuffer.counts);
  gpu.dispatch("prepare", params,
               {{kPrepareRawDepth, *frame.depth},
                {kPrepareRawNormal, frame.normal ? *frame.normal : *frame.depth},
                {kPrepareDepth, *gbuffer.depth},
                {kPrepareNormal, *gbuffer.normal},
                {kPrepareCounts, *gbuffer.counts}},
               extent_of(frame.view));
  return gbuffer;
}

gpu::Buffer& estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings) {
  switch (settings.estimator) {
    case Estimator::gtao: return horizon(gpu, gbuffer, frame, settings);
    case Estimator::bitmask: return bitmask(gpu, gbuffer, frame, settings);
    default: fail(ErrorKind::usage, "estimator not built yet");
  }
}

gpu::Buffer& horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings) {
  gpu::Buffer& ao = gpu.buffer("ao", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("horizon", slice_parameters<HorizonParams>(gbuffer, frame, settings),
               {{kHorizonDepth, *gbuffer.depth}, {kHorizonNormal, *gbuffer.normal}, {kHorizonAo, ao}}, extent_of(gbuffer.view), slice_constants(settings));
  return ao;
}

gpu::Buffer& bitmask(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings) {
  gpu::Buffer& ao = gpu.buffer("ao", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("bitmask", slice_parameters<BitmaskParams>(gbuffer, frame, settings),
               {{kBitmaskDepth, *gbuffer.depth}, {kBitmaskNormal, *gbuffer.normal}, {kBitmaskAo, ao}}, extent_of(gbuffer.view), slice_constants(settings));
  return ao;
}

gpu::Buffer& shape(gpu::Recorder& gpu, const gpu::Buffer& ao, const View& view, const EstimatorSettings& settings) {
  gpu::Buffer& shaped = gpu.buffer("shaped", plane_bytes(view), gpu::Use::download);
  const ShapeParams params{view.size, float(settings.intensity), float(settings.power)};
  gpu.dispatch("shape", params, {{kShapeAo, ao}, {kShapeShaped, shaped}}, extent_of(view));
  return shaped;
}

gpu::Buffer& composite(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame) {
  gpu::Buffer& result = gpu.buffer("composite", frame.beauty->bytes(), gpu::Use::download);
  const CompositeParams params{frame.view.size, frame.has_alpha ? 1u : 0u, frame.indirect ? 1u : 0u, frame.diffuse_color ? 1u : 0u};
  gpu.dispatch("composite", params,
               {{kCompositeAo, ao},
                {kCompositeBeauty, *frame.beauty},
                {kCompositeIndirect, frame.indirect ? *frame.indirect : *frame.beauty},
                {kCompositeDiffuseColor, frame.diffuse_color ? *frame.diffuse_color : *frame.beauty},
                {kCompositeResult, result},
                {kCompositeCounts, *gbuffer.counts}},
               extent_of(frame.view));
  return result;
}

}  // namespace alcove
