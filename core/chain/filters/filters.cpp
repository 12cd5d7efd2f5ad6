// Host side of the kernels that smooth the visibility and bring it to all pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/filters/filters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/sites.h"
#include "kernels/estimate/exact.h"
#include "kernels/filters/filters.h"

namespace alcove {
namespace {

/// The Gaussian's standard deviation, in radii of the denoiser.
constexpr double kDenoiseSigma = 0.6;

std::vector<double> gaussian(int radius) {
  std::vector<double> weights;
  const double sigma = kDenoiseSigma * radius;
  for (int i = 0; i <= radius; i++) weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  return weights;
}

/// Filters reach no farther than this part of the radius.
constexpr double kFilteredPart = 0.4;

/// The narrowness of interpolate's parabola that is 0 a pixel beyond the radius.
double narrowness_of(const EstimatorSettings& settings) {
  const double end = denoise_radius_of(settings) + 1;
  return 1 / (end * end);
}

std::vector<double> parabola(double narrowness, int reach) {
  std::vector<double> weights;
  for (int i = 0; i <= reach; i++) weights.push_back(1 - narrowness * i * i);
  return weights;
}

/// Makes weights, from the centre outwards, reach for sites where there may be few.
std::vector<double> reaching(std::vector<double> weights, int reach) {
  const double least = kLeastWindow * weights.front();
  weights.resize(std::size_t(reach) + 1, 0.0);
  for (double& weight : weights) weight = std::max(weight, least);
  return weights;
}

std::optional<Denoiser::OfBlocks> of_blocks(const EstimatorSettings& settings) {
  constexpr int kWidest = 16;
  const bool is_free =
      settings.denoise_kernel.empty() && settings.denoise_radius == 0 && settings.denoise_depth_sigma == 0;
  if (!is_adaptive(settings) || !is_free || spacing_of(settings) != kWidest) return {};
  // With few slices noise outweighs what changes from site to site.
  return settings.slices < 3 ? Denoiser::OfBlocks{17, 8, 0.25F} : Denoiser::OfBlocks{14, 0.5F, 1};
}

/// The distance from which interpolate or denoise takes estimates of others, in pixels of the estimate: 0 without a
/// denoiser. Where pixels share estimates it is at least 3 px with an adaptive density, in which each pixel then has
/// one, and 8 with a uniform one, in which small surfaces may have none: these stay open.
int denoise_reach_of(const EstimatorSettings& settings) {
  // What has an estimated error is not mixed with its neighbours.
  if (settings.denoise == Denoise::none || settings.tolerance > 0) return 0;
  if (settings.denoise == Denoise::box) return 2;
  if (of_blocks(settings)) return 0;
  const auto& kernel = settings.denoise_kernel;
  const int radius = kernel.empty() ? denoise_radius_of(settings) : int(kernel.size()) - 1;
  if (spacing_of(settings) == 1) return radius;
  return std::max(radius, is_adaptive(settings) ? 3 : 8);
}

std::vector<double> weights_of(const EstimatorSettings& settings) {
  const auto& kernel = settings.denoise_kernel;
  const int reach = denoise_reach_of(settings);
  if (reach == 0) return {};
  // The mean of the four boxes of 4 x 4 that hold a pixel: 4 wide, and centred.
  if (settings.denoise == Denoise::box) return {1, 1, 0.5};
  if (spacing_of(settings) == 1) return kernel.empty() ? gaussian(denoise_radius_of(settings)) : kernel;
  return reaching(kernel.empty() ? parabola(narrowness_of(settings), reach) : kernel, reach);
}

/// The parameters of the filter, without the axis.
template <class Params>
Params filter_params(const GBuffer& gbuffer, const Denoiser& denoiser) {
  Params params{};
  params.view = gbuffer.view;
  params.depth_sigma = float(denoiser.depth_sigma);
  const auto& weights = denoiser.weights;
  const double sum = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
  std::ranges::transform(weights, params.weight, [&](double weight) { return float(weight / sum); });
  return params;
}

/// How many pixels wide a length is at unit depth (orthographic: at any).
float pixels_of(const GBuffer& gbuffer, double length) {
  return float(length / double(gbuffer.view.tangent_per_pixel.x));
}

/// The largest reach of filters by radius; infinite where nothing is shared, or no radius is known.
std::vector<double> within_of(const EstimatorSettings& settings) {
  if (!is_adaptive(settings) || !settings.radius) return {HUGE_VAL};
  std::vector<double> within = radii_of(settings);
  for (double& radius : within) radius *= kFilteredPart;
  return within;
}

}  // namespace

int denoise_radius_of(const EstimatorSettings& settings) {
  if (settings.denoise_radius > 0) return settings.denoise_radius;
  return spacing_of(settings) > 1 ? 8 : 4;
}

Visibility combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& of_radii, bool keeps_scales) {
  const uint radii = planes_in(*of_radii.ao, gbuffer.view);
  if (radii == 1) return of_radii;
  gpu::Buffer& mean = gpu.buffer("combined", plane_bytes(gbuffer.view));
  gpu.dispatch("combine", CombineParams{gbuffer.view.size, radii}, {{"Scales", of_radii.ao}, {"Ao", mean}},
               extent_of(gbuffer.view));
  return {&mean, keeps_scales ? of_radii.ao : nullptr, of_radii.moments};
}

int filter_reach_of(const EstimatorSettings& settings) {
  const int denoised = denoiser_of(settings).reach();
  const int refined = settings.tolerance > 0 ? kRefineReach : 0;
  return int(settings.resolution) * (denoised + refined + (settings.resolution == Resolution::full ? 0 : 2));
}

Denoiser denoiser_of(const EstimatorSettings& settings) {
  return {weights_of(settings),        settings.denoise_depth_sigma,
          denoise_radius_of(settings), !settings.denoise_kernel.empty(),
          of_blocks(settings),         within_of(settings)};
}

int Denoiser::reach() const { return of_blocks ? kBlocksReach : std::max(int(weights.size()) - 1, 0); }

namespace {

/// Runs a filter along rows, and then along columns. `more`: bindings of its own; `constants`: along an axis, those by
/// which it differs from others.
template <class Params, class Constants>
gpu::Buffer& in_rows_and_columns(gpu::Recorder& gpu, const char* kernel, Params params, const GBuffer& gbuffer,
                                 gpu::Buffer& planes, const std::string& prefix, const std::vector<gpu::Binding>& more,
                                 const Constants& constants) {
  gpu::Buffer& rows = gpu.buffer(prefix + "denoised rows", planes.bytes());
  gpu::Buffer& result = gpu.buffer(prefix + "denoised", planes.bytes());
  const ivec2 size = gbuffer.view.size;
  const auto along = [&](ivec2 axis, const gpu::Buffer& from, const gpu::Buffer& to) {
    params.axis = axis;
    std::vector<gpu::Binding> bindings{
        {"Ao", from}, {"Depth", gbuffer.depth}, {"Normal", gbuffer.normal}, {"Result", to}};
    bindings.insert(bindings.end(), more.begin(), more.end());
    const int lines = axis.x ? size.y : size.x, length = axis.x ? size.x : size.y;
    gpu.dispatch(kernel, params, bindings, {uint(lines), groups_of(length, uint(kDenoiseRun))}, constants(axis));
  };
  along({1, 0}, planes, rows);
  along({0, 1}, rows, result);
  return result;
}

}  // namespace

gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Denoiser& denoiser,
                     const std::string& prefix) {
  if (denoiser.weights.empty()) return planes;
  const std::vector<uint> constants{uint(denoiser.weights.size() - 1), denoiser.depth_sigma > 0 ? 1u : 0u,
                                    planes_in(planes, gbuffer.view)};
  return in_rows_and_columns(gpu, "denoise", filter_params<DenoiseParams>(gbuffer, denoiser), gbuffer, planes, prefix,
                             {}, [&](ivec2) { return constants; });
}

gpu::Buffer& interpolate(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Sites& sites,
                         const Denoiser& denoiser, const std::string& prefix, uint moments) {
  const auto radius = uint(denoiser.weights.size() - 1);
  const std::size_t written_runs =
      groups_of(gbuffer.view.size.x, uint(kDenoiseRun)) * groups_of(gbuffer.view.size.y, 32);
  const gpu::Buffer& written = gpu.buffer(prefix + "written rows", sizeof(uint) * written_runs);
  gpu.clear(written);
  InterpolateParams params = filter_params<InterpolateParams>(gbuffer, denoiser);
  params.most = float(denoiser.radius);
  params.reach = pixels_of(gbuffer, denoiser.within.front());
  params.grid = sites.grid;
  const uint mode =
      (denoiser.depth_sigma > 0 ? kInterpolateByDepth : 0) | (denoiser.looks_up ? kInterpolateLooksUp : 0);
  return in_rows_and_columns(gpu, "interpolate", params, gbuffer, planes, prefix,
                             {{"Runs", written}, {"Blocks", sites.words}}, [&](ivec2 axis) {
                               return std::vector<uint>{radius, mode | (axis.y ? kInterpolateColumns : 0),
                                                        planes_in(planes, gbuffer.view), moments};
                             });
}

const gpu::Buffer& fit_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& planes, const Sites& sites,
                              const Denoiser& denoiser, const std::string& prefix, uint moments) {
  const auto& of = *denoiser.of_blocks;
  const uint count = planes_in(planes, gbuffer.view);
  const gpu::Buffer& fitted = gpu.buffer(prefix + "fitted", site_bytes(sites.grid, 2 * sizeof(uint) * count));
  const bool by_radius = moments == 0 && count == denoiser.within.size();
  const uint together = by_radius ? 1 : count;
  const auto within_of_plane = [&](uint plane) {
    if (by_radius) return denoiser.within[plane];
    return moments == count ? denoiser.within.back() : denoiser.within.front();  // moments alone: see of_radius()
  };
  for (uint first = 0; first < count; first += together) {
    const float reach = pixels_of(gbuffer, within_of_plane(first));
    gpu.dispatch("fit_blocks", FitBlocksParams{gbuffer.view, sites.grid, reach, of.most, of.held, int(first)},
                 {{"Blocks", sites.words},
                  {"Planes", sites.planes},
                  {"List", sites.list},
                  {"Counts", sites.counts},
                  {"Ao", planes},
                  {"Fitted", fitted}},
                 sites.extent, {together});
  }
  return fitted;
}

gpu::Buffer& spread_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& fitted, const Sites& sites,
                           const Denoiser& denoiser, const std::string& prefix, uint moments) {
  const std::size_t planes = fitted.bytes() / site_bytes(sites.grid, 2 * sizeof(uint));
  gpu::Buffer& result = gpu.buffer(prefix + "denoised", planes * plane_bytes(gbuffer.view));
  gpu.dispatch("spread_blocks", SpreadBlocksParams{gbuffer.view, sites.grid, denoiser.of_blocks->slope},
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Blocks", sites.words},
                {"Planes", sites.planes},
                {"Fitted", fitted},
                {"Result", result}},
               {2 * uint(sites.grid.blocks.x), 2 * uint(sites.grid.blocks.y)}, {uint(planes), moments});
  return result;
}

gpu::Buffer& smooth(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Sites& sites,
                    const Denoiser& denoiser, const std::string& prefix, uint moments) {
  if (denoiser.of_blocks) {
    const gpu::Buffer& fitted = fit_blocks(gpu, gbuffer, planes, sites, denoiser, prefix, moments);
    return spread_blocks(gpu, gbuffer, fitted, sites, denoiser, prefix, moments);
  }
  return sites.words ? interpolate(gpu, gbuffer, planes, sites, denoiser, prefix, moments)
                     : denoise(gpu, gbuffer, planes, denoiser, prefix);
}

gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, gpu::Buffer& low_planes,
                      const std::string& prefix) {
  const BlockGrid& grid = low.grid;
  if (grid.factor == 1) return low_planes;
  const uint count = planes_in(low_planes, low.view);
  gpu::Buffer& planes = gpu.buffer(prefix + "upsampled", count * plane_bytes(gbuffer.view));
  gpu.dispatch("upsample", UpsampleParams{gbuffer.view, grid.size, grid.overhang},
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"LowDepth", low.depth},
                {"LowNormal", low.normal},
                {"LowAo", low_planes},
                {"Ao", planes}},
               {uint(grid.size.x + 1), uint(grid.size.y + 1)}, {uint(grid.factor), count});
  return planes;
}

namespace {

/// Filters all planes of a visibility, one member after the other.
template <class Filter>
Visibility each_of(const Visibility& visibility, const Filter& filter) {
  Visibility result;
  result.ao = filter(*visibility.ao, "");
  if (visibility.scales) result.scales = filter(*visibility.scales, kScalesPrefix);
  if (visibility.moments) result.moments = filter(*visibility.moments, kMomentsPrefix);
  return result;
}

}  // namespace

Visibility smooth(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Sites& sites,
                  const Denoiser& denoiser, uint order) {
  return each_of(visibility, [&](gpu::Buffer& planes, const char* prefix) {
    const uint moments = &planes == visibility.moments ? uint(moments_in(order)) : 0;
    return &smooth(gpu, gbuffer, planes, sites, denoiser, prefix, moments);
  });
}

Visibility upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const Visibility& visibility) {
  return each_of(visibility,
                 [&](gpu::Buffer& planes, const char* prefix) { return &upsample(gpu, gbuffer, low, planes, prefix); });
}

}  // namespace alcove
