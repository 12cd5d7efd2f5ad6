// Host side of the kernels that smooth the visibility and bring it to all pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/filters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/estimator_facts.h"
#include "core/chain/pass_common.h"
#include "kernels/combine.h"
#include "kernels/denoise.h"
#include "kernels/dilate.h"
#include "kernels/upsample.h"

namespace alcove {
namespace {

/// The Gaussian's standard deviation, in radii of the denoiser.
constexpr double kDenoiseSigma = 0.6;

std::vector<double> weights_of(const EstimatorSettings& settings) {
  // What has an estimated error is not mixed with its neighbours.
  if (settings.denoise == Denoise::none || settings.tolerance > 0) return {};
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

/// The parameters of the filter, without the axis.
DenoiseParams denoise_params(const GBuffer& gbuffer, const Denoiser& denoiser) {
  DenoiseParams params{};
  params.view = gbuffer.view;
  params.origin = gbuffer.grid.origin;
  params.depth_sigma = float(denoiser.depth_sigma);
  const auto& weights = denoiser.weights;
  const double sum = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
  std::ranges::transform(weights, params.weight, [&](double weight) { return float(weight / sum); });
  return params;
}

}  // namespace

Visibility combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, bool keeps_scales) {
  const uint radii = planes_in(*estimate.ao, gbuffer.view);
  if (radii == 1) return {estimate.ao, nullptr, estimate.bent};
  gpu::Buffer& mean = gpu.buffer("combined", plane_bytes(gbuffer.view), gpu::Use::download);
  gpu.dispatch("combine", CombineParams{gbuffer.view.size, radii}, {{kCombineScales, *estimate.ao}, {kCombineAo, mean}},
               extent_of(gbuffer.view));
  return {&mean, keeps_scales ? estimate.ao : nullptr, estimate.bent};
}

Denoiser denoiser_of(const EstimatorSettings& settings) {
  return {weights_of(settings), settings.denoise_depth_sigma, stride_of(settings)};
}

FilterRuns dilate(gpu::Recorder& gpu, const GBuffer& gbuffer, const TileList& tiles, const Denoiser& denoiser) {
  // A list costs as much as a twentieth of the filter: it pays where more than sky is left out.
  if (!tiles.skips_surfaces) return {};
  const BlockGrid& grid = gbuffer.grid;
  const bool denoises = !denoiser.weights.empty();
  const bool upsamples = grid.factor > 1;
  const int radius = denoises ? int(denoiser.weights.size()) - 1 : 0;
  const int width = gbuffer.view.size.x;
  const int height = gbuffer.view.size.y;
  if (!denoises && !upsamples) return {};
  const auto groups = [](int pixels, int size) { return int(groups_of(pixels, uint(size))); };
  const int in_column = groups(height, kDenoiseRun);
  const int in_row = groups(width + denoiser.stride - 1, kDenoiseRun);
  const gpu::Buffer& columns =
      gpu.buffer("runs along columns", sizeof(uint) * std::size_t(in_column * groups(width, kTile)), gpu::Use::device);
  const auto list = [&](const std::string& name, int runs, int lines, uint mode, const gpu::Buffer& result) {
    const RunList out{&gpu.buffer(name, sizeof(uint) * std::size_t(runs * lines), gpu::Use::device),
                      &gpu.buffer(name + " counts", sizeof(RunCounts), gpu::Use::device)};
    gpu.clear(*out.counts);
    gpu.dispatch("dilate",
                 DilateParams{gbuffer.view.size, runs, lines, in_column, grid.frame_size, grid.overhang, grid.factor},
                 {{kDilateTiles, *tiles.sectors},
                  {kDilateColumns, columns},
                  {kDilateList, *out.runs},
                  {kDilateCounts, *out.counts},
                  {kDilateResult, result}},
                 {uint(runs), uint(lines)}, {uint(radius), uint(denoiser.stride), mode});
    return out;
  };
  FilterRuns listed;
  if (denoises) {
    const gpu::Buffer& result = denoised(gpu, "", plane_bytes(gbuffer.view));
    listed.columns = list("listed columns", in_column, groups(width, kTile), kDilateAlongColumns, result);
    listed.rows = list("listed rows", in_row, groups(height, kTile), kDilateAlongRows, result);
  }
  if (upsamples) {
    const std::size_t bytes = sizeof(float) * std::size_t(grid.frame_size.x) * std::size_t(grid.frame_size.y);
    listed.blocks = list("listed blocks", groups(width + 1, kGroupX), groups(height + 1, kGroupY), kDilateUpsample,
                         upsampled(gpu, "", bytes));
  }
  return listed;
}

gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Denoiser& denoiser,
                     const std::string& prefix, const FilterRuns& runs) {
  if (denoiser.weights.empty()) return planes;
  const auto radius = uint(denoiser.weights.size() - 1);
  DenoiseParams params = denoise_params(gbuffer, denoiser);
  gpu::Buffer& rows = gpu.buffer(prefix + "denoised rows", planes.bytes(), gpu::Use::device);
  gpu::Buffer& result = denoised(gpu, prefix, planes.bytes());
  const auto along = [&](ivec2 axis, const RunList& listed, const gpu::Buffer& from, const gpu::Buffer& to, uint sparse,
                         int stride) {
    params.axis = axis;
    const int length = axis.x ? gbuffer.view.size.x : gbuffer.view.size.y;
    const int lines = axis.x ? gbuffer.view.size.y : gbuffer.view.size.x;
    const gpu::Extent every_run(uint(lines), groups_of(length + stride - 1, uint(kDenoiseRun)));
    gpu.dispatch("denoise", params,
                 {{kDenoiseAo, from},
                  {kDenoiseDepth, *gbuffer.depth},
                  {kDenoiseNormal, *gbuffer.normal},
                  {kDenoiseResult, to},
                  {kDenoiseList, listed.runs ? *listed.runs : from},
                  {kDenoiseCounts, listed.counts ? *listed.counts : from}},
                 listed.counts ? gpu::Extent(*listed.counts) : every_run,
                 {radius, denoiser.depth_sigma > 0 ? 1u : 0u, sparse | (listed.runs ? kDenoiseListed : 0), uint(stride),
                  planes_in(planes, gbuffer.view)});
  };
  const bool is_dense = denoiser.stride == 1;
  along({1, 0}, runs.rows, planes, rows, is_dense ? kDenoiseDense : kDenoiseSparseRows, denoiser.stride);
  along({0, 1}, runs.columns, rows, result, is_dense ? kDenoiseDense : kDenoiseSparseColumns, 1);
  return result;
}

Visibility denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Denoiser& denoiser,
                   const FilterRuns& runs) {
  Visibility result;
  result.ao = &denoise(gpu, gbuffer, *visibility.ao, denoiser, "", runs);
  if (visibility.scales) result.scales = &denoise(gpu, gbuffer, *visibility.scales, denoiser, kScalesPrefix);
  if (visibility.bent) result.bent = &denoise(gpu, gbuffer, *visibility.bent, denoiser, kBentPrefix);
  return result;
}

gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, gpu::Buffer& low_planes,
                      const std::string& prefix, const FilterRuns& runs) {
  const BlockGrid& grid = low.grid;
  if (grid.factor == 1) return low_planes;
  const uint count = planes_in(low_planes, low.view);
  gpu::Buffer& planes = upsampled(gpu, prefix, count * plane_bytes(gbuffer.view));
  const RunList& listed = runs.blocks;
  const gpu::Extent every_block(uint(grid.size.x + 1), uint(grid.size.y + 1));
  gpu.dispatch("upsample", UpsampleParams{gbuffer.view, grid.size, grid.overhang},
               {{kUpsampleDepth, *gbuffer.depth},
                {kUpsampleNormal, *gbuffer.normal},
                {kUpsampleLowDepth, *low.depth},
                {kUpsampleLowNormal, *low.normal},
                {kUpsampleLowAo, low_planes},
                {kUpsampleAo, planes},
                {kUpsampleList, listed.runs ? *listed.runs : low_planes},
                {kUpsampleCounts, listed.counts ? *listed.counts : low_planes}},
               listed.counts ? gpu::Extent(*listed.counts) : every_block,
               {uint(grid.factor), count, listed.runs ? 1u : 0u});
  return planes;
}

Visibility upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const Visibility& visibility,
                    const FilterRuns& runs) {
  Visibility result;
  result.ao = &upsample(gpu, gbuffer, low, *visibility.ao, "", runs);
  if (visibility.scales) result.scales = &upsample(gpu, gbuffer, low, *visibility.scales, kScalesPrefix);
  if (visibility.bent) result.bent = &upsample(gpu, gbuffer, low, *visibility.bent, kBentPrefix);
  return result;
}

}  // namespace alcove
