// Host side of every kernel.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/passes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "kernels/bent_normal.h"
#include "kernels/bitmask.h"
#include "kernels/combine.h"
#include "kernels/composite.h"
#include "kernels/crytek.h"
#include "kernels/debug.h"
#include "kernels/denoise.h"
#include "kernels/directions.h"
#include "kernels/downsample.h"
#include "kernels/exact.h"
#include "kernels/hbao.h"
#include "kernels/horizon.h"
#include "kernels/multi_bounce.h"
#include "kernels/prepare.h"
#include "kernels/profile.h"
#include "kernels/reconstruct.h"
#include "kernels/shape.h"
#include "kernels/specular_occlusion.h"
#include "kernels/upsample.h"

namespace alcove {
namespace {

/// The Gaussian's standard deviation, in radii of the denoiser.
constexpr double kDenoiseSigma = 0.6;

std::size_t pixels_of(const View& view) { return std::size_t(view.size.x) * std::size_t(view.size.y); }
std::size_t plane_bytes(const View& view) { return pixels_of(view) * sizeof(float); }
uint planes_in(const gpu::Buffer& buffer, const View& view) { return uint(buffer.bytes() / plane_bytes(view)); }

/// As kernels take it: 0 says as deep as wide.
float thickness_of(const EstimatorSettings& settings) {
  if (settings.thickness == ThicknessKind::automatic) return 0;
  return settings.thickness == ThicknessKind::infinite ? std::numeric_limits<float>::infinity() : float(settings.thickness_length);
}

gpu::Extent extent_of(const View& view) { return {uint(view.size.x), uint(view.size.y)}; }
uint groups_of(int pixels, uint size) { return (uint(pixels) + size - 1) / size; }
vec3 to_vec3(const std::array<double, 3>& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

uint normal_form_of(const FrameInputs& frame) {
  if (!frame.normal) return kNormalNone;
  if (frame.normal_encoding == NormalEncoding::octahedral) return kNormalOctahedral;
  if (frame.normal_encoding == NormalEncoding::spheremap) return kNormalSpheremap;
  return frame.normal->bytes() < 3 * plane_bytes(frame.view) ? kNormalXy : kNormalVector;
}

uint range_check_of(RangeCheck check) {
  return check == RangeCheck::ratio ? kRangeRatio : check == RangeCheck::smoothstep ? kRangeSmoothstep : kRangeNone;
}

/// Where the noise pattern of a frame and seed begins: successive frames take successive points of the R2 sequence, seeds of another.
vec2 noise_shift(int frame, std::uint32_t seed) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  const auto shift = [&](double by_frame, double by_seed) { return float(fraction(0.5 + fraction(frame * by_frame) + fraction(seed * by_seed))); };
  return {shift(0.75487766624669276, 0.41421356237309505), shift(0.56984029099805327, 0.73205080756887729)};
}

/// Of the estimators that search slices.
template <class Params>
Params slice_parameters(const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings, uint plane) {
  const double radius = settings.radius.value();
  Params params{};
  params.view = gbuffer.view;
  params.radius = float(radius * settings.falloff_end);
  params.falloff_start = float(radius * settings.falloff_start);
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(frame.frame, settings.seed);
  params.thickness = thickness_of(settings);
  params.bias = float(settings.bias);
  params.plane = plane;
  params.depth_precision = to_vec3(frame.depth_precision.at);
  return params;
}
std::vector<uint> slice_constants(const EstimatorSettings& settings, const gpu::Buffer* bent = nullptr) {
  return {uint(settings.slices), uint(settings.steps), uint(settings.falloff) | (bent ? kWithBent : 0), uint(stride_of(settings))};
}

/// The invocations that make an estimate: one for each pixel that the stride does not leave out.
gpu::Extent estimated_extent(const View& view, const EstimatorSettings& settings) {
  const auto stride = uint(stride_of(settings));
  return {(uint(view.size.x) + stride - 1) / stride, uint(view.size.y)};
}

/// How far a profile may leave a pixel's depth, in the pixel's own widths: less costs more vertices.
constexpr float kProfileTolerance = 0.2f;

/// Directions of an exact search over a frame: each pixel takes all of them, or a quarter where a denoiser mixes those of its block of 2 x 2.
int directions_of(const EstimatorSettings& settings) { return settings.slices * (settings.denoise == Denoise::none ? 1 : 4); }

/// Pixels that lines have moved across at a step: as in lines.glsl.
int shift_at(const Lines& lines, int step) { return (lines.slope * (lines.origin.x + step) + kSlopeUnit / 2) >> kSlopeBits; }

/// The lines of a direction, even in angle where the view's pixels are made square; those of a few directions never follow an axis of the image.
Lines lines_of(const View& view, ivec2 origin, int direction, int directions) {
  const double angle = std::numbers::pi * (direction + 0.5) / directions;
  const double x = std::cos(angle) / view.tangent_per_pixel.x, y = std::sin(angle) / view.tangent_per_pixel.y;
  const bool steep = std::abs(y) > std::abs(x);
  Lines lines{steep ? 1u : 0u, int(std::lround(kSlopeUnit * (steep ? x / y : y / x))), steep ? ivec2{origin.y, origin.x} : origin, 0};
  const int across = steep ? view.size.x : view.size.y;
  const int most = std::max(std::abs(shift_at(lines, 0)), std::abs(shift_at(lines, steep ? view.size.y : view.size.x)));
  lines.wrap = (most / across + 1) * across;
  return lines;
}

/// The grid of blocks that the pixels of an estimate stand for: it begins at the display window's corner, so that a crop has the blocks of the whole.
struct BlockGrid {
  int factor;      // px of a block in x and in y
  ivec2 origin;    // blocks from the display window's corner to the first one of the data window
  ivec2 overhang;  // px of that one outside of the data window
  ivec2 size;      // blocks
};

BlockGrid block_grid(const FrameInputs& frame, const EstimatorSettings& settings) {
  const int factor = int(settings.resolution);
  const auto floored = [&](int px) { return px / factor - (px % factor < 0 ? 1 : 0); };
  const ivec2 origin{floored(frame.noise_origin.x), floored(frame.noise_origin.y)};
  const ivec2 overhang{frame.noise_origin.x - factor * origin.x, frame.noise_origin.y - factor * origin.y};
  return {factor, origin, overhang, {floored(overhang.x + frame.view.size.x + factor - 1), floored(overhang.y + frame.view.size.y + factor - 1)}};
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

}  // namespace

GBuffer prepare(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Use depth_use, const std::string& prefix) {
  GBuffer gbuffer{frame.view, &gpu.buffer(prefix + "depth", plane_bytes(frame.view), depth_use),
                  &gpu.buffer(prefix + "normal", plane_bytes(frame.view), gpu::Use::device),
                  &gpu.buffer(prefix + "counts", sizeof(FrameCounts), gpu::Use::download),
                  &gpu.buffer(prefix + "missing", sizeof(GroupCount), gpu::Use::upload)};
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
  gbuffer.missing->as<GroupCount>()[0] = {groups_of(frame.view.size.x, kGroupX), groups_of(frame.view.size.y, kGroupY), 0};
  gpu.upload(*gbuffer.missing);
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
  gpu.dispatch("reconstruct", ReconstructParams{gbuffer.view}, {{kReconstructDepth, *gbuffer.depth}, {kReconstructNormal, *gbuffer.normal}},
               gpu::Extent(*gbuffer.missing));
}

GBuffer downsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings) {
  const BlockGrid grid = block_grid(frame, settings);
  const auto size = float(grid.factor);
  GBuffer low = gbuffer;
  low.view.size = grid.size;
  low.view.center = {(gbuffer.view.center.x + float(grid.overhang.x)) / size, (gbuffer.view.center.y + float(grid.overhang.y)) / size};
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

bool searches_exactly(const EstimatorSettings& settings) { return settings.estimator == Estimator::gtao && settings.search != SliceSearch::steps; }

int stride_of(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return 1;
  if (settings.stride > 0) return settings.stride;
  const bool shared = settings.denoise == Denoise::bilateral && settings.resolution == Resolution::full && settings.slices <= 2;
  return shared && settings.estimator == Estimator::gtao ? 4 : 1;
}

std::vector<double> radii_of(const EstimatorSettings& settings) {
  std::vector<double> radii = settings.further_radii;
  radii.push_back(settings.radius.value());
  std::ranges::sort(radii);
  return radii;
}

bool has_bent_normals(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::bitmask || (settings.estimator == Estimator::gtao && !searches_exactly(settings));
}

Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& inputs, const EstimatorSettings& settings, bool with_bent) {
  FrameInputs frame = inputs;
  frame.noise_origin = block_grid(inputs, settings).origin;
  const auto radii = radii_of(settings);
  Estimate all{&gpu.buffer("ao", radii.size() * plane_bytes(gbuffer.view), gpu::Use::download)};
  if (with_bent) all.bent = &gpu.buffer("bent", 3 * plane_bytes(gbuffer.view), gpu::Use::download);
  for (uint plane = 0; plane < radii.size(); plane++) {
    EstimatorSettings one = settings;
    one.radius = radii[plane];
    const Estimate out{all.ao, plane + 1 == radii.size() ? all.bent : nullptr};
    switch (settings.estimator) {
      case Estimator::gtao:
        if (!searches_exactly(one)) horizon(gpu, gbuffer, frame, one, out, plane);
        for (int direction = 0; searches_exactly(one) && direction < directions_of(one); direction++) {
          const Profile lines = profile(gpu, gbuffer, frame, one, direction);
          exact(gpu, gbuffer, lines, frame, one, out, plane);
        }
        break;
      case Estimator::bitmask: bitmask(gpu, gbuffer, frame, one, out, plane); break;
      case Estimator::hbao: hbao(gpu, gbuffer, frame, one, out, plane); break;
      case Estimator::crytek: crytek(gpu, gbuffer, frame, one, out, plane); break;
    }
  }
  return all;
}

void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings, const Estimate& out, uint plane) {
  std::vector<uint> constants = slice_constants(settings, out.bent);
  constants.push_back(settings.thickness == ThicknessKind::automatic  ? kThicknessWidth
                      : settings.thickness == ThicknessKind::constant ? kThicknessLength
                                                                      : kThicknessEndless);
  gpu.dispatch("horizon", slice_parameters<HorizonParams>(gbuffer, frame, settings, plane),
               {{kHorizonDepth, *gbuffer.depth}, {kHorizonNormal, *gbuffer.normal}, {kHorizonAo, *out.ao}, {kHorizonBent, out.bent ? *out.bent : *out.ao}},
               estimated_extent(gbuffer.view, settings), constants);
}

Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings, int direction) {
  const std::size_t bytes = plane_bytes(gbuffer.view);
  const Lines lines = lines_of(gbuffer.view, frame.noise_origin, direction, directions_of(settings));
  const Profile result{direction, lines, &gpu.buffer("profile vertex", bytes, gpu::Use::device), &gpu.buffer("profile mark", bytes, gpu::Use::device),
                       &gpu.buffer("profile neighbor", bytes, gpu::Use::device)};
  const ivec2 size = gbuffer.view.size;
  const auto [least, most] = std::minmax({shift_at(lines, 0), shift_at(lines, (lines.steep ? size.y : size.x) - 1)});
  const ProfileParams params{gbuffer.view, lines, -most, uint((lines.steep ? size.x : size.y) + most - least), kProfileTolerance};
  gpu.dispatch("profile", params,
               {{kProfileDepth, *gbuffer.depth},
                {kProfileVertex, *result.vertex},
                {kProfileMark, *result.mark},
                {kProfileNeighbor, *result.neighbor}},
               {params.count}, {settings.search == SliceSearch::every_pixel ? 1u : 0u});
  return result;
}

void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const FrameInputs& frame, const EstimatorSettings& settings, const Estimate& out,
           uint plane) {
  const Lines& lines = profile.lines;
  const int directions = directions_of(settings), takers = directions / settings.slices;
  ExactParams params{};
  params.view = gbuffer.view;
  params.lines = lines;
  params.stride = takers > 1 ? 2 : 1;
  // Neighbouring directions go to opposite corners of a block; blocks are those of the display window.
  constexpr ivec2 kCorners[] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  const ivec2 corner = kCorners[profile.direction % takers];
  if (takers > 1) params.first = {(corner.x + lines.origin.x) & 1, (corner.y + lines.origin.y) & 1};
  params.direction = uint(profile.direction);
  params.is_first = profile.direction < takers ? 1 : 0;
  params.is_last = profile.direction >= directions - takers ? 1 : 0;
  params.radius = float(settings.radius.value() * settings.falloff_end);
  params.thickness = thickness_of(settings);
  params.bias = float(settings.bias);
  params.depth_precision = to_vec3(frame.depth_precision.at);
  params.plane = plane;
  const ivec2 size = gbuffer.view.size, taken{(size.x + params.stride - 1) / params.stride, (size.y + params.stride - 1) / params.stride};
  gpu.dispatch("exact", params,
               {{kExactDepth, *gbuffer.depth},
                {kExactNormal, *gbuffer.normal},
                {kExactVertex, *profile.vertex},
                {kExactMark, *profile.mark},
                {kExactNeighbor, *profile.neighbor},
                {kExactWhole, gpu.buffer("whole arcs", plane_bytes(gbuffer.view), gpu::Use::device)},
                {kExactAo, *out.ao}},
               lines.steep ? gpu::Extent{uint(taken.y), uint(taken.x)} : gpu::Extent{uint(taken.x), uint(taken.y)});
}

void bitmask(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings, const Estimate& out, uint plane) {
  gpu.dispatch("bitmask", slice_parameters<BitmaskParams>(gbuffer, frame, settings, plane),
               {{kBitmaskDepth, *gbuffer.depth}, {kBitmaskNormal, *gbuffer.normal}, {kBitmaskAo, *out.ao}, {kBitmaskBent, out.bent ? *out.bent : *out.ao}},
               estimated_extent(gbuffer.view, settings), slice_constants(settings, out.bent));
}

void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings, const Estimate& out, uint plane) {
  const double radius = settings.radius.value();
  HbaoParams params{};
  params.view = gbuffer.view;
  params.radius = float(radius * settings.falloff_end);
  params.falloff_start = float(radius * settings.falloff_start);
  params.bias = float(settings.bias);
  params.from_surface = settings.elevation == Elevation::surface ? 1 : 0;
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(frame.frame, settings.seed);
  params.plane = plane;
  params.depth_precision = to_vec3(frame.depth_precision.at);
  gpu.dispatch("hbao", params, {{kHbaoDepth, *gbuffer.depth}, {kHbaoNormal, *gbuffer.normal}, {kHbaoAo, *out.ao}},
               estimated_extent(gbuffer.view, settings), slice_constants(settings));
}

void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings, const Estimate& out, uint plane) {
  CrytekParams params{};
  params.view = gbuffer.view;
  params.radius = float(settings.radius.value());
  params.bias = float(settings.bias);
  params.uniform_volume = settings.sample_kernel == SampleKernel::uniform ? 1 : 0;
  params.range_check = range_check_of(settings.range_check);
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(frame.frame, settings.seed);
  params.plane = plane;
  params.depth_precision = to_vec3(frame.depth_precision.at);
  gpu.dispatch("crytek", params, {{kCrytekDepth, *gbuffer.depth}, {kCrytekNormal, *gbuffer.normal}, {kCrytekAo, *out.ao}},
               estimated_extent(gbuffer.view, settings), {uint(settings.samples), uint(stride_of(settings))});
}

gpu::Buffer& combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& scales) {
  gpu::Buffer& ao = gpu.buffer("combined", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("combine", CombineParams{gbuffer.view.size, planes_in(scales, gbuffer.view)}, {{kCombineScales, scales}, {kCombineAo, ao}}, extent_of(gbuffer.view));
  return ao;
}

gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame, const EstimatorSettings& settings,
                     const std::string& prefix) {
  const std::vector<double> weights = denoise_weights(settings);
  const auto radius = uint(weights.size() - 1);
  DenoiseParams params{};
  params.view = gbuffer.view;
  params.origin = block_grid(frame, settings).origin;
  params.depth_sigma = float(settings.denoise_depth_sigma);
  const double sum = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
  std::ranges::transform(weights, params.weight, [&](double weight) { return float(weight / sum); });
  gpu::Buffer& rows = gpu.buffer(prefix + "denoised rows", ao.bytes(), gpu::Use::device);
  gpu::Buffer& result = gpu.buffer(prefix + "denoised", ao.bytes(), gpu::Use::download);
  const auto along = [&](ivec2 axis, const gpu::Buffer& from, const gpu::Buffer& to, uint sparse, uint stride) {
    params.axis = axis;
    const uint length = uint(axis.x ? gbuffer.view.size.x : gbuffer.view.size.y), others = uint(axis.x ? gbuffer.view.size.y : gbuffer.view.size.x);
    gpu.dispatch("denoise", params,
                 {{kDenoiseAo, from}, {kDenoiseDepth, *gbuffer.depth}, {kDenoiseNormal, *gbuffer.normal}, {kDenoiseResult, to}},
                 {others, (length + stride - 1 + kDenoiseRun - 1) / kDenoiseRun},
                 {radius, settings.denoise_depth_sigma > 0 ? 1u : 0u, sparse, stride, planes_in(ao, gbuffer.view)});
  };
  const bool dense = stride_of(settings) == 1;
  along({1, 0}, ao, rows, dense ? kDenoiseDense : kDenoiseSparseRows, uint(stride_of(settings)));
  along({0, 1}, rows, result, dense ? kDenoiseDense : kDenoiseSparseColumns, 1);
  return result;
}

gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const gpu::Buffer& low_ao, const FrameInputs& frame,
                      const EstimatorSettings& settings, const std::string& prefix) {
  const uint planes = planes_in(low_ao, low.view);
  gpu::Buffer& ao = gpu.buffer(prefix + "upsampled", planes * plane_bytes(gbuffer.view), gpu::Use::download);
  const BlockGrid grid = block_grid(frame, settings);
  const UpsampleParams params{gbuffer.view, grid.size, grid.overhang};
  gpu.dispatch("upsample", params,
               {{kUpsampleDepth, *gbuffer.depth},
                {kUpsampleNormal, *gbuffer.normal},
                {kUpsampleLowDepth, *low.depth},
                {kUpsampleLowNormal, *low.normal},
                {kUpsampleLowAo, low_ao},
                {kUpsampleAo, ao}},
               {uint(grid.size.x + 1), uint(grid.size.y + 1)}, {uint(grid.factor), planes});
  return ao;
}

gpu::Buffer& bent_normal(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& bent) {
  gpu::Buffer& result = gpu.buffer("bent normal", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("bent_normal", BentNormalParams{gbuffer.view.size},
               {{kBentNormalNormal, *gbuffer.normal}, {kBentNormalBent, bent}, {kBentNormalResult, result}}, extent_of(gbuffer.view));
  return result;
}

bool shapes(const EstimatorSettings& settings) { return settings.intensity != 1 || settings.power != 1 || settings.fade_end; }

gpu::Buffer& shape(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame, const EstimatorSettings& settings,
                   const std::string& prefix) {
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

gpu::Buffer& specular_occlusion(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& bent, const gpu::Buffer& ao, const EstimatorSettings& settings) {
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
  gpu.dispatch("multi_bounce", params, {{kMultiBounceAo, ao}, {kMultiBounceAlbedo, frame.albedo ? *frame.albedo : ao}, {kMultiBounceResult, result}},
               extent_of(gbuffer.view));
  return result;
}

gpu::Buffer& composite(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame, const OutputSettings& output) {
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

gpu::Buffer& directions(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& packed, const std::string& name, const FrameInputs& frame) {
  gpu::Buffer& planes = gpu.buffer(name, 3 * plane_bytes(gbuffer.view), gpu::Use::download);
  const DirectionsParams params{gbuffer.view.size, to_vec3(frame.aov_from_view[0]), to_vec3(frame.aov_from_view[1]), to_vec3(frame.aov_from_view[2])};
  gpu.dispatch("directions", params, {{kDirectionsDepth, *gbuffer.depth}, {kDirectionsPacked, packed}, {kDirectionsPlanes, planes}}, extent_of(gbuffer.view));
  return planes;
}

DebugPlane debug(gpu::Recorder& gpu, const DebugView& view, const GBuffer& gbuffer, const DebugStages& stages, const FrameInputs& frame,
                 const EstimatorSettings& settings) {
  const bool is_stage = view.source == DebugSource::raw_ao || view.source == DebugSource::denoised_ao;
  const GBuffer& shown = is_stage ? stages.gbuffer : gbuffer;
  const gpu::Buffer* values = shown.normal;
  if (is_stage) values = view.source == DebugSource::raw_ao ? stages.raw_ao : stages.denoised_ao;
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
  gpu.dispatch("debug", params, {{kDebugDepth, *shown.depth}, {kDebugNormal, *shown.normal}, {kDebugValues, *values}, {kDebugResult, result}},
               extent_of(shown.view));
  return {&view, shown.view.size, &result};
}

}  // namespace alcove
