// Host side of every kernel but the estimators'.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/chain/pass_common.h"
#include "kernels/bent_normal.h"
#include "kernels/combine.h"
#include "kernels/composite.h"
#include "kernels/debug.h"
#include "kernels/denoise.h"
#include "kernels/dilate.h"
#include "kernels/directions.h"
#include "kernels/downsample.h"
#include "kernels/multi_bounce.h"
#include "kernels/prepare.h"
#include "kernels/reconstruct.h"
#include "kernels/shape.h"
#include "kernels/specular_occlusion.h"
#include "kernels/upsample.h"

namespace alcove {
namespace {

/// The Gaussian's standard deviation, in radii of the denoiser.
constexpr double kDenoiseSigma = 0.6;

uint normal_form_of(const FrameInputs& frame) {
  if (!frame.normal) return kNormalNone;
  if (frame.normal_encoding == NormalEncoding::octahedral) return kNormalOctahedral;
  if (frame.normal_encoding == NormalEncoding::spheremap) return kNormalSpheremap;
  return frame.normal->bytes() < 3 * plane_bytes(frame.view) ? kNormalXy : kNormalVector;
}

/// The denoiser's weights from the centre outwards; each is as good as any multiple of it.
std::vector<double> denoise_weights(const EstimatorSettings& settings) {
  // The mean of the four boxes of 4 x 4 that hold a pixel: 4 wide, and centred.
  if (settings.denoise == Denoise::box) return {1, 1, 0.5};
  if (!settings.denoise_kernel.empty()) return settings.denoise_kernel;
  std::vector<double> weights;
  const double sigma = kDenoiseSigma * settings.denoise_radius;
  for (int i = 0; i <= settings.denoise_radius; i++) weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  return weights;
}

gpu::Buffer& denoised(gpu::Recorder& gpu, const std::string& prefix, std::size_t bytes) {
  return gpu.buffer(prefix + "denoised", bytes, gpu::Use::download);
}

gpu::Buffer& upsampled(gpu::Recorder& gpu, const std::string& prefix, std::size_t bytes) {
  return gpu.buffer(prefix + "upsampled", bytes, gpu::Use::download);
}

}  // namespace

BlockGrid block_grid(const FrameInputs& frame, const EstimatorSettings& settings) {
  const int factor = int(settings.resolution);
  const auto floored = [&](int px) { return px / factor - (px % factor < 0 ? 1 : 0); };
  const ivec2 origin{floored(frame.noise_origin.x), floored(frame.noise_origin.y)};
  const ivec2 overhang{frame.noise_origin.x - factor * origin.x, frame.noise_origin.y - factor * origin.y};
  return {factor,
          origin,
          overhang,
          {floored(overhang.x + frame.view.size.x + factor - 1), floored(overhang.y + frame.view.size.y + factor - 1)}};
}

OpenSky open_sky(gpu::Recorder& gpu, const FrameInputs& frame, const EstimatorSettings& settings) {
  const ivec2 size = block_grid(frame, settings).size;
  const OpenSky sky{
      &gpu.buffer("open sky counts", sizeof(FrameCounts), gpu::Use::upload),
      &gpu.buffer("open sky tile counts", sizeof(TileCounts), gpu::Use::upload),
      &gpu.buffer("open sky", plane_bytes(frame.view), gpu::Use::upload),
      &gpu.buffer("open sky scales", radii_of(settings).size() * plane_bytes(frame.view), gpu::Use::upload)};
  sky.counts->as<FrameCounts>()[0] = {uint(pixels_of(frame.view)), 0, 0, 0, 0};
  sky.tiles->as<TileCounts>()[0] = {{}, 0, groups_of(size.x, uint(kTile)) * groups_of(size.y, uint(kTile)), 0, 0, 0};
  for (const auto* planes : {sky.ao, sky.scales}) std::ranges::fill(planes->as<float>(), 1.0f);
  return sky;
}

GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Use depth_use, const std::string& prefix) {
  GBuffer gbuffer{frame.view, &gpu.buffer(prefix + "depth", plane_bytes(frame.view), depth_use),
                  &gpu.buffer(prefix + "normal", plane_bytes(frame.view), gpu::Use::device),
                  &gpu.buffer(prefix + "counts", sizeof(FrameCounts), gpu::Use::download),
                  &gpu.buffer(prefix + "missing", sizeof(GroupCount), gpu::Use::device)};
  PrepareParams params{};
  params.view = frame.view;
  params.view_from_normal_x = to_vec3(frame.view_from_normal[0]);
  params.view_from_normal_y = to_vec3(frame.view_from_normal[1]);
  params.view_from_normal_z = to_vec3(frame.view_from_normal[2]);
  const DepthMap& map = frame.depth_map;
  params.depth_axis = to_vec3(map.axis);
  params.along_ray = map.along_ray ? 1 : 0;
  params.origin = float(map.origin);
  params.base = float(map.base);
  params.slope = float(map.slope);
  params.sky_below = float(map.sky_below);
  params.sky_above = float(map.sky_above);
  params.sky_depth = float(map.sky_depth);
  params.normal_unorm = frame.normal_unorm ? 1 : 0;
  gpu.clear(*gbuffer.counts);
  gpu.write(*gbuffer.missing,
            GroupCount{groups_of(frame.view.size.x, kGroupX), groups_of(frame.view.size.y, kGroupY), 0});
  gpu.dispatch("prepare", params,
               {{kPrepareRawDepth, *frame.depth},
                {kPrepareRawNormal, frame.normal ? *frame.normal : *frame.depth},
                {kPrepareDepth, *gbuffer.depth},
                {kPrepareNormal, *gbuffer.normal},
                {kPrepareCounts, *gbuffer.counts},
                {kPrepareMissing, *gbuffer.missing}},
               extent_of(frame.view), {map.form, normal_form_of(frame)});
  return gbuffer;
}

void reconstruct(gpu::Recorder& gpu, const GBuffer& gbuffer) {
  gpu.dispatch("reconstruct", ReconstructParams{gbuffer.view},
               {{kReconstructDepth, *gbuffer.depth}, {kReconstructNormal, *gbuffer.normal}},
               gpu::Extent(*gbuffer.missing));
}

GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                   const EstimatorSettings& settings) {
  const BlockGrid grid = block_grid(frame, settings);
  const auto size = float(grid.factor);
  GBuffer low = gbuffer;
  low.view.size = grid.size;
  low.view.center = {(gbuffer.view.center.x + float(grid.overhang.x)) / size,
                     (gbuffer.view.center.y + float(grid.overhang.y)) / size};
  low.view.tangent_per_pixel = {gbuffer.view.tangent_per_pixel.x * size, gbuffer.view.tangent_per_pixel.y * size};
  low.depth = &gpu.buffer("low depth", plane_bytes(low.view), gpu::Use::device);
  low.normal = &gpu.buffer("low normal", plane_bytes(low.view), gpu::Use::device);
  const DownsampleParams params{gbuffer.view, grid.size, grid.overhang};
  gpu.dispatch("downsample", params,
               {{kDownsampleDepth, *gbuffer.depth},
                {kDownsampleNormal, *gbuffer.normal},
                {kDownsampleLowDepth, *low.depth},
                {kDownsampleLowNormal, *low.normal}},
               extent_of(low.view), {uint(grid.factor)});
  return low;
}

gpu::Buffer& combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& scales) {
  gpu::Buffer& ao = gpu.buffer("combined", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("combine", CombineParams{gbuffer.view.size, planes_in(scales, gbuffer.view)},
               {{kCombineScales, scales}, {kCombineAo, ao}}, extent_of(gbuffer.view));
  return ao;
}

FilterRuns dilate(gpu::Recorder& gpu, const GBuffer& gbuffer, const TileList& tiles, const FrameInputs& frame,
                  const EstimatorSettings& settings) {
  // A list costs as much as a twentieth of the filter: it pays where more than sky is left out.
  if (!tiles.sectors || settings.no_skip || !(frame.changes || proves(settings))) return {};
  const bool denoises = settings.denoise != Denoise::none, upsamples = settings.resolution != Resolution::full;
  const int radius = denoises ? int(denoise_weights(settings).size()) - 1 : 0, stride = stride_of(settings);
  if (!denoises && !upsamples) return {};
  const BlockGrid grid = block_grid(frame, settings);
  const auto [width, height] = std::pair(gbuffer.view.size.x, gbuffer.view.size.y);
  const auto whole = [](int pixels, int each) { return int(groups_of(pixels, uint(each))); };
  const int in_column = whole(height, kDenoiseRun), in_row = whole(width + stride - 1, kDenoiseRun);
  const gpu::Buffer& columns =
      gpu.buffer("runs along columns", sizeof(uint) * std::size_t(in_column * whole(width, kTile)), gpu::Use::device);
  const auto list = [&](const std::string& name, int runs, int lines, uint mode, const gpu::Buffer& result) {
    const RunList out{&gpu.buffer(name, sizeof(uint) * std::size_t(runs * lines), gpu::Use::device),
                      &gpu.buffer(name + " counts", sizeof(RunCounts), gpu::Use::device)};
    gpu.clear(*out.counts);
    gpu.dispatch("dilate",
                 DilateParams{gbuffer.view.size, runs, lines, in_column, frame.view.size, grid.overhang, grid.factor},
                 {{kDilateTiles, *tiles.sectors},
                  {kDilateColumns, columns},
                  {kDilateList, *out.runs},
                  {kDilateCounts, *out.counts},
                  {kDilateResult, result}},
                 {uint(runs), uint(lines)}, {uint(radius), uint(stride), mode});
    return out;
  };
  FilterRuns all;
  if (denoises) {
    const gpu::Buffer& result = denoised(gpu, "", plane_bytes(gbuffer.view));
    all.columns = list("listed columns", in_column, whole(width, kTile), kDilateAlongColumns, result);
    all.rows = list("listed rows", in_row, whole(height, kTile), kDilateAlongRows, result);
  }
  if (upsamples)
    all.blocks = list("listed blocks", whole(width + 1, kGroupX), whole(height + 1, kGroupY), kDilateUpsample,
                      upsampled(gpu, "", plane_bytes(frame.view)));
  return all;
}

gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame,
                     const EstimatorSettings& settings, const std::string& prefix, const FilterRuns& runs) {
  const std::vector<double> weights = denoise_weights(settings);
  const auto radius = uint(weights.size() - 1);
  DenoiseParams params{};
  params.view = gbuffer.view;
  params.origin = block_grid(frame, settings).origin;
  params.depth_sigma = float(settings.denoise_depth_sigma);
  const double sum = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
  std::ranges::transform(weights, params.weight, [&](double weight) { return float(weight / sum); });
  gpu::Buffer& rows = gpu.buffer(prefix + "denoised rows", ao.bytes(), gpu::Use::device);
  gpu::Buffer& result = denoised(gpu, prefix, ao.bytes());
  const auto along = [&](ivec2 axis, const RunList& listed, const gpu::Buffer& from, const gpu::Buffer& to, uint sparse,
                         uint stride) {
    params.axis = axis;
    const uint length = uint(axis.x ? gbuffer.view.size.x : gbuffer.view.size.y),
               others = uint(axis.x ? gbuffer.view.size.y : gbuffer.view.size.x);
    gpu.dispatch("denoise", params,
                 {{kDenoiseAo, from},
                  {kDenoiseDepth, *gbuffer.depth},
                  {kDenoiseNormal, *gbuffer.normal},
                  {kDenoiseResult, to},
                  {kDenoiseList, listed.runs ? *listed.runs : from},
                  {kDenoiseCounts, listed.counts ? *listed.counts : from}},
                 listed.counts ? gpu::Extent(*listed.counts)
                               : gpu::Extent(others, (length + stride - 1 + kDenoiseRun - 1) / kDenoiseRun),
                 {radius, settings.denoise_depth_sigma > 0 ? 1u : 0u, sparse | (listed.runs ? kDenoiseListed : 0),
                  stride, planes_in(ao, gbuffer.view)});
  };
  const bool dense = stride_of(settings) == 1;
  along({1, 0}, runs.rows, ao, rows, dense ? kDenoiseDense : kDenoiseSparseRows, uint(stride_of(settings)));
  along({0, 1}, runs.columns, rows, result, dense ? kDenoiseDense : kDenoiseSparseColumns, 1);
  return result;
}

gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const gpu::Buffer& low_ao,
                      const FrameInputs& frame, const EstimatorSettings& settings, const std::string& prefix,
                      const FilterRuns& runs) {
  const uint planes = planes_in(low_ao, low.view);
  gpu::Buffer& ao = upsampled(gpu, prefix, planes * plane_bytes(gbuffer.view));
  const RunList& listed = runs.blocks;
  const BlockGrid grid = block_grid(frame, settings);
  const UpsampleParams params{gbuffer.view, grid.size, grid.overhang};
  gpu.dispatch("upsample", params,
               {{kUpsampleDepth, *gbuffer.depth},
                {kUpsampleNormal, *gbuffer.normal},
                {kUpsampleLowDepth, *low.depth},
                {kUpsampleLowNormal, *low.normal},
                {kUpsampleLowAo, low_ao},
                {kUpsampleAo, ao},
                {kUpsampleList, listed.runs ? *listed.runs : low_ao},
                {kUpsampleCounts, listed.counts ? *listed.counts : low_ao}},
               listed.counts ? gpu::Extent(*listed.counts) : gpu::Extent(uint(grid.size.x + 1), uint(grid.size.y + 1)),
               {uint(grid.factor), planes, listed.runs ? 1u : 0u});
  return ao;
}

gpu::Buffer& bent_normal(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& bent) {
  gpu::Buffer& result = gpu.buffer("bent normal", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("bent_normal", BentNormalParams{gbuffer.view.size},
               {{kBentNormalNormal, *gbuffer.normal}, {kBentNormalBent, bent}, {kBentNormalResult, result}},
               extent_of(gbuffer.view));
  return result;
}

bool shapes(const EstimatorSettings& settings) {
  return settings.intensity != 1 || settings.power != 1 || settings.fade_end;
}

gpu::Buffer& shape(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame,
                   const EstimatorSettings& settings, const std::string& prefix) {
  gpu::Buffer& shaped = gpu.buffer(prefix + "shaped", ao.bytes(), gpu::Use::download);
  ShapeParams params{};
  params.size = gbuffer.view.size;
  params.intensity = float(settings.intensity);
  params.power = float(settings.power);
  params.fade_start = float(settings.fade_start.value_or(0));
  params.fade_end = float(settings.fade_end.value_or(0));
  params.has_fade = settings.fade_end ? 1 : 0;
  params.has_material = frame.material_ao ? 1 : 0;
  params.planes = planes_in(ao, gbuffer.view);
  params.counts_repaired = prefix.empty() ? 1 : 0;
  gpu.dispatch("shape", params,
               {{kShapeAo, ao},
                {kShapeShaped, shaped},
                {kShapeDepth, *gbuffer.depth},
                {kShapeMaterial, frame.material_ao ? *frame.material_ao : ao},
                {kShapeCounts, *gbuffer.counts}},
               extent_of(gbuffer.view));
  return shaped;
}

gpu::Buffer& specular_occlusion(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& bent,
                                const gpu::Buffer& ao, const EstimatorSettings& settings) {
  gpu::Buffer& result = gpu.buffer("specular occlusion", plane_bytes(gbuffer.view), gpu::Use::download);
  const SpecularOcclusionParams params{gbuffer.view, float(settings.roughness)};
  gpu.dispatch("specular_occlusion", params,
               {{kSpecularOcclusionDepth, *gbuffer.depth},
                {kSpecularOcclusionNormal, *gbuffer.normal},
                {kSpecularOcclusionBent, bent},
                {kSpecularOcclusionAo, ao},
                {kSpecularOcclusionResult, result}},
               extent_of(gbuffer.view));
  return result;
}

gpu::Buffer& multi_bounce(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame) {
  gpu::Buffer& result = gpu.buffer("color ao", 3 * plane_bytes(gbuffer.view), gpu::Use::download);
  const MultiBounceParams params{gbuffer.view.size, frame.albedo ? 1u : 0u, float(frame.albedo_value)};
  gpu.dispatch(
      "multi_bounce", params,
      {{kMultiBounceAo, ao}, {kMultiBounceAlbedo, frame.albedo ? *frame.albedo : ao}, {kMultiBounceResult, result}},
      extent_of(gbuffer.view));
  return result;
}

gpu::Buffer& composite(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame,
                       const OutputSettings& output) {
  gpu::Buffer& result = gpu.buffer("composite", frame.beauty->bytes(), gpu::Use::download);
  CompositeParams params{};
  params.view = frame.view;
  params.has_alpha = frame.has_alpha ? 1 : 0;
  params.has_ambient = frame.indirect ? 1 : 0;
  params.has_diffuse_color = frame.diffuse_color ? 1 : 0;
  params.has_color = output.multi_bounce ? 1 : 0;
  params.fog_density = float(output.fog_density);
  gpu.dispatch("composite", params,
               {{kCompositeAo, ao},
                {kCompositeBeauty, *frame.beauty},
                {kCompositeIndirect, frame.indirect ? *frame.indirect : *frame.beauty},
                {kCompositeDiffuseColor, frame.diffuse_color ? *frame.diffuse_color : *frame.beauty},
                {kCompositeResult, result},
                {kCompositeCounts, *gbuffer.counts},
                {kCompositeDepth, *gbuffer.depth}},
               extent_of(frame.view));
  return result;
}

gpu::Buffer& directions(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& packed, const std::string& name,
                        const FrameInputs& frame) {
  gpu::Buffer& planes = gpu.buffer(name, 3 * plane_bytes(gbuffer.view), gpu::Use::download);
  const DirectionsParams params{gbuffer.view.size, to_vec3(frame.aov_from_view[0]), to_vec3(frame.aov_from_view[1]),
                                to_vec3(frame.aov_from_view[2])};
  gpu.dispatch("directions", params,
               {{kDirectionsDepth, *gbuffer.depth}, {kDirectionsPacked, packed}, {kDirectionsPlanes, planes}},
               extent_of(gbuffer.view));
  return planes;
}

DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages,
                 const FrameInputs& frame, const EstimatorSettings& settings) {
  const bool is_stage = view.source == DebugSource::raw_ao || view.source == DebugSource::denoised_ao ||
                        view.source == DebugSource::tiles;
  const GBuffer& shown = is_stage ? stages.gbuffer : gbuffer;
  const gpu::Buffer* values = shown.normal;
  if (is_stage) values = view.source == DebugSource::raw_ao ? stages.raw_ao : stages.denoised_ao;
  if (view.source == DebugSource::tiles) values = stages.sectors;
  if (view.source == DebugSource::raw_depth) values = frame.depth;
  if (view.source == DebugSource::normals_from_depth) {
    FrameInputs depth_only = frame;
    depth_only.normal = nullptr;
    const GBuffer from_depth = prepare(gpu, depth_only, gpu::Use::device, "debug ");
    reconstruct(gpu, from_depth);
    values = from_depth.normal;
  }
  gpu::Buffer& result = gpu.buffer(std::string("debug ") + view.name, plane_bytes(shown.view), gpu::Use::download);
  const int stride = view.source == DebugSource::raw_ao ? stride_of(settings) : 1;
  const DebugParams params{shown.view, view.kind, stride, block_grid(frame, settings).origin};
  gpu.dispatch(
      "debug", params,
      {{kDebugDepth, *shown.depth}, {kDebugNormal, *shown.normal}, {kDebugValues, *values}, {kDebugResult, result}},
      extent_of(shown.view));
  return {&view, shown.view.size, &result};
}

}  // namespace alcove
