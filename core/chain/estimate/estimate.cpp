// Host side of the estimators, and of what they leave out.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/exact.h"
#include "core/chain/filters/filters.h"
#include "kernels/estimate/estimate.h"

namespace alcove {
namespace {

/// Returns the thickness as kernels take it: 0 stands for as deep as wide.
float thickness_of(const EstimatorSettings& settings) {
  switch (settings.thickness) {
    case ThicknessKind::automatic: return 0;
    case ThicknessKind::infinite: return std::numeric_limits<float>::infinity();
    case ThicknessKind::constant: break;
  }
  return float(settings.thickness_length);
}

/// The farthest, in scene units, that a front may lie away for its solid to reach into the radius. Where what blocks
/// fades towards the radius, that has no weight.
double front_reach_of(const EstimatorSettings& settings, double radius) {
  double thickness = 0;
  if (settings.falloff == Falloff::none && settings.thickness == ThicknessKind::automatic)
    thickness = 2.0 / 3 * kWidestRun * radius;
  if (settings.falloff == Falloff::none && settings.thickness == ThicknessKind::constant)
    thickness = settings.thickness_length;
  return std::max(radius + thickness, kFarEnd * radius);
}

uint thickness_rule_of(float thickness) {
  if (thickness == 0) return kThicknessWidth;
  return std::isinf(thickness) ? kThicknessEndless : kThicknessLength;
}

uint range_check_of(RangeCheck check) {
  switch (check) {
    case RangeCheck::none: break;
    case RangeCheck::ratio: return kRangeRatio;
    case RangeCheck::smoothstep: return kRangeSmoothstep;
  }
  return kRangeNone;
}

/// Returns where the noise pattern begins. Where it is animated, successive frames take successive points of the R2
/// sequence; seeds take those of another sequence.
vec2 noise_shift(int frame, std::uint32_t seed) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  const auto shift = [&](double by_frame, double by_seed) {
    return float(fraction(0.5 + fraction(frame * by_frame) + fraction(seed * by_seed)));
  };
  return {shift(kR2X, kRootX), shift(kR2Y, kRootY)};
}

/// The completed surfaces, as kernels take them.
uint completion_of(const Reach& reach) {
  switch (reach.complete) {
    case Completion::none: break;
    case Completion::border: return kCompletesBorder;
    case Completion::all: return kCompletesBorder | (completes_behind(reach) ? kCompletesHidden : 0u);
  }
  return 0;
}

/// Blocks of tiles in x and y.
gpu::Extent block_extent(const View& view) {
  return {groups_of(view.size.x, uint(kTile * kTileBlock)), groups_of(view.size.y, uint(kTile * kTileBlock))};
}

/// The buffers that all estimators take, but for those of the exact search.
std::vector<gpu::Binding> buffers_of(const GBuffer& gbuffer, const Estimate& out) {
  return {{"Depth", gbuffer.depth},
          {"Occluders", occluder_depth_of(gbuffer)},
          {"Normal", gbuffer.normal},
          {"Ao", out.ao},
          {"List", out.listed.tiles},
          {"Counts", out.listed.counts},
          {"Sites", gpu::Optional(out.listed.sites)},
          {"SiteCountsBuffer", gpu::Optional(out.listed.site_counts)}};
}

// Steps at least of the search for curvature alone, and slices where no filter smooths it.
constexpr int kCurvatureSteps = 16, kUnfilteredSlices = 8;

double samples_of_a_radius(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::crytek ? settings.samples : 2 * settings.slices * settings.steps;
}

/// The workgroups of an estimator over the listed sites or tiles.
gpu::Extent estimate_extent(const TileList& list) {
  if (!list.sites) return list_extent(list);
  return listed_extent(*list.site_counts, groups_of(int(list.sites->bytes() / sizeof(uint)), kGroupX * kGroupY));
}

}  // namespace

bool depends_on_depth(const EstimatorSettings& settings) { return settings.radius_auto || settings.radius_in_medians; }

void take_radii(EstimatorSettings& settings, const std::vector<double>& radii) {
  settings.radius = radii.front();
  settings.further_radii.assign(radii.begin() + 1, radii.end());
  settings.radius_auto = settings.radius_in_medians = false;
}

std::vector<double> radii_of(const EstimatorSettings& settings) {
  std::vector<double> radii = settings.further_radii;
  radii.push_back(settings.radius.value());
  std::ranges::sort(radii);
  return radii;
}

bool searches_exactly(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::gtao && (settings.search == SliceSearch::exact || settings.tolerance > 0);
}

bool searches_slices(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::gtao || settings.estimator == Estimator::bitmask;
}

bool tells_backs(const EstimatorSettings& settings) {
  return searches_slices(settings) && settings.search == SliceSearch::steps &&
         settings.thickness == ThicknessKind::automatic;
}

bool completes(const EstimatorSettings& settings) {
  return searches_slices(settings) && settings.complete == Completion::all &&
         settings.thickness != ThicknessKind::infinite;
}

bool completes_anywhere(const EstimatorSettings& settings) {
  return searches_slices(settings) && settings.complete != Completion::none;
}

double samples_of(const EstimatorSettings& settings, double estimates) {
  if (searches_exactly(settings)) return 0;
  return samples_of_a_radius(settings) * double(1 + settings.further_radii.size()) * estimates;
}

gpu::Extent list_extent(const TileList& list) {
  return listed_extent(*list.counts, uint(list.tiles->bytes() / sizeof(uint)));
}

Reach reach_of(const EstimatorSettings& settings, double radius) {
  // Crytek's samples fill the sphere of the radius whatever the falloff.
  const double end = settings.estimator == Estimator::crytek ? 1 : settings.falloff_end;
  return {float(radius * end),
          float(radius * end * (tells_backs(settings) ? 1 + kMostBack + kLongestChain : 1)),
          float(front_reach_of(settings, radius * end)),
          float(radius * settings.falloff_start),
          settings.falloff,
          thickness_of(settings),
          float(settings.bias),
          settings.complete,
          settings.estimator == Estimator::bitmask};
}

bool completes_behind(const Reach& reach) { return reach.complete == Completion::all && !std::isinf(reach.thickness); }

uint solid_of(const Reach& reach, bool tells_backs) {
  return thickness_rule_of(reach.thickness) | completion_of(reach) | (tells_backs ? kTellsBacks : 0);
}

Sampling sampling_of(const EstimatorSettings& settings, int frame) {
  return {settings.slices, settings.steps, noise_shift(settings.noise == Noise::animated ? frame : 0, settings.seed)};
}

Skipping skipping_of(const EstimatorSettings& settings, const FrameInputs& frame, const BlockGrid& grid) {
  return {!settings.no_skip, settings.no_skip ? nullptr : frame.changes,
          without_margin(frame, grid, filter_reach_of(settings))};
}

Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                  const EstimatorSettings& settings, uint order, bool with_completed, bool with_curvature) {
  const std::size_t plane = plane_bytes(gbuffer.view), radii = radii_of(settings).size();
  Estimate result{&gpu.buffer("ao", radii * plane)};
  const std::size_t further = moments_in(order) + (with_curvature ? 2 * radii : 0);
  if (further > 0) result.moments = &gpu.buffer("moments", further * plane);
  result.order = order;
  const bool has_own = with_curvature && (searches_exactly(settings) || !searches_slices(settings));
  if (with_curvature && !has_own) result.curvature = uint(moments_in(order));
  if (with_completed) result.completed = &gpu.buffer("completed", plane);
  if (!searches_exactly(settings))
    estimate_sampled(gpu, gbuffer, sites, frame, settings, result);
  else
    estimate_exact(gpu, gbuffer, settings, result);
  if (has_own) estimate_curvature(gpu, gbuffer, sites, frame, settings, result, uint(moments_in(order)));
  return result;
}

Estimate of_radius(const Estimate& all, uint plane, std::size_t radii) {
  const bool is_largest = plane + 1 == radii;
  Estimate out{all.ao, plane};
  if (is_largest || all.curvature) out.moments = all.moments;
  if (all.curvature) out.curvature = *all.curvature + 2 * plane;
  if (is_largest) out.order = all.order;
  if (is_largest) out.completed = all.completed;
  return out;
}

void estimate_sampled(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                      const EstimatorSettings& settings, Estimate& result) {
  const auto radii = radii_of(settings);
  const Sampling sampling = sampling_of(settings, frame.frame);
  Skipping skipping = skipping_of(settings, frame, gbuffer.grid);
  // Tiles that are as in the frame before keep what it found in them.
  if (result.completed && !skipping.changes) gpu.clear(*result.completed);
  skipping.bounds = bounds(gpu, gbuffer, skipping);
  for (uint plane = 0; plane < radii.size(); plane++) {
    const Reach reach = reach_of(settings, radii[plane]);
    Estimate out = of_radius(result, plane, radii.size());
    out.listed = classify(gpu, gbuffer, skipping, reach, sites, out);
    list_sites(gpu, gbuffer, sites, out.listed);
    if (tells_backs(settings)) out.told = &backs(gpu, gbuffer, reach, frame[RawPlane::normal] != nullptr).words;
    switch (settings.estimator) {
      case Estimator::gtao:
      case Estimator::bitmask: horizon(gpu, gbuffer, reach, sampling, out); break;
      case Estimator::hbao: hbao(gpu, gbuffer, reach, sampling, settings.elevation, out); break;
      case Estimator::crytek: crytek(gpu, gbuffer, reach, sampling, settings, out); break;
    }
    result.listed = out.listed;
    result.told = out.told;
  }
}

void estimate_curvature(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                        const EstimatorSettings& settings, const Estimate& result, uint first) {
  EstimatorSettings sampled = settings;
  sampled.estimator = Estimator::gtao;
  sampled.search = SliceSearch::steps;
  sampled.thickness = ThicknessKind::infinite;  // what is not the own surface does not matter
  sampled.complete = Completion::none;
  sampled.tolerance = 0;
  Sampling sampling = sampling_of(settings, frame.frame);
  if (!denoiser_of(settings).smooths()) sampling.slices = std::max(sampling.slices, kUnfilteredSlices);
  sampling.steps = std::max(sampling.steps, kCurvatureSteps);
  const auto radii = radii_of(settings);
  for (uint plane = 0; plane < radii.size(); plane++) {
    const Reach reach = reach_of(sampled, radii[plane]);
    Estimate out{&gpu.buffer("curvature ao", plane_bytes(gbuffer.view))};
    out.moments = result.moments;
    out.curvature = first + 2 * plane;
    out.listed = classify(gpu, gbuffer, {false, nullptr}, reach, sites, out, "curvature ");
    list_sites(gpu, gbuffer, sites, out.listed, "curvature ");
    horizon(gpu, gbuffer, reach, sampling, out);
  }
}

const gpu::Buffer* bounds(gpu::Recorder& gpu, const GBuffer& gbuffer, const Skipping& skipping) {
  if (!skipping.skips_sky || !gbuffer.hidden) return nullptr;
  const gpu::Extent blocks = block_extent(gbuffer.view);
  gpu::Buffer& result = gpu.buffer("bounds", sizeof(vec2) * blocks.x * blocks.y);
  gpu.dispatch("bounds", BoundsParams{gbuffer.view.size, gbuffer.surfaces - 1},
               {{"Depth", gbuffer.depth}, {"Hidden", gbuffer.hidden}, {"Blocks", result}}, blocks);
  return &result;
}

TileList classify(gpu::Recorder& gpu, const GBuffer& gbuffer, const Skipping& skipping, const Reach& reach,
                  const Sites& sites, const Estimate& out, const std::string& prefix) {
  const gpu::Extent tiles = tile_extent(gbuffer.view);
  const gpu::Extent blocks = block_extent(gbuffer.view);
  TileList list;
  list.tiles = &gpu.buffer("tiles", sizeof(uint) * tiles.x * tiles.y);
  list.counts = &gpu.buffer(prefix + "tile counts", sizeof(TileCounts));
  list.kinds = &gpu.buffer(prefix + "tile kinds", sizeof(uint) * tiles.x * tiles.y);
  const bool selects = skipping.skips_sky && gbuffer.needed;
  gpu.clear(*list.counts);
  const uint mode = (skipping.skips_sky ? kClassifySkips : 0) | (out.order > 0 ? kClassifyWithFirst : 0) |
                    (out.order > 1 ? kClassifyWithSecond : 0) | (out.completed ? kClassifyWithCompleted : 0) |
                    (out.curvature ? kClassifyWithCurvature : 0) | (skipping.changes ? kClassifyReuses : 0) |
                    (selects ? kClassifySelects : 0) | (gbuffer.surfaces > 1 ? kClassifyLayered : 0);
  // Where pixels tell how far back they are solid, a known back says otherwise wherever that may reach into the sphere.
  const bool has_backs = reach.told > reach.radius;
  const float front = has_backs ? std::max(reach.front, (1 + kMostBack) * reach.radius) : reach.front;
  const ClassifyParams params{gbuffer.view,
                              reach.radius,
                              reach.told,
                              front,
                              out.plane,
                              out.curvature.value_or(0),
                              gbuffer.grid.frame_size,
                              gbuffer.grid.overhang,
                              gbuffer.grid.factor,
                              gbuffer.surfaces > 1 ? kHiddenChangeMargin : kChangeMargin,
                              sites.grid,
                              skipping.needed.from,
                              skipping.needed.to};
  gpu.dispatch("classify", params,
               {{"Bounds", gpu::Optional(skipping.bounds)},
                {"Changes", gpu::Optional(skipping.changes)},
                {"Needed", gpu::Optional(gbuffer.needed)},
                {"Depth", gbuffer.depth},
                {"Blocks", gpu::Optional(sites.words)},
                {"List", list.tiles},
                {"Counts", list.counts},
                {"Kinds", list.kinds},
                {"Ao", out.ao},
                {"Moments", gpu::Optional(out.moments)},
                {"Completed", gpu::Optional(out.completed)}},
               {groups_of(int(blocks.x), kGroupY) * kGroupX, blocks.y * kGroupY}, {sites.words ? 1u : 0u, mode});
  return list;
}

Backs backs(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, bool has_normals) {
  const View& view = gbuffer.view;
  const std::size_t segments = std::size_t(view.size.y) * groups_of(view.size.x, kSegment) +
                               std::size_t(view.size.x) * groups_of(view.size.y, kSegment);
  const std::size_t bytes = segments * 2 * sizeof(uint);
  const gpu::Buffer &chains = gpu.buffer("chains", bytes), &ends = gpu.buffer("chain ends", bytes);
  const gpu::Buffer& words = gpu.buffer("backs", plane_bytes(view));
  const BacksParams params{view, reach.radius, has_normals ? 1u : 0u};
  gpu.dispatch("chains", params,
               {{"Depth", occluder_depth_of(gbuffer)}, {"Normal", gbuffer.normal}, {"Chains", chains}},
               {uint(std::min<std::size_t>(segments, kChainsRow)), groups_of(int(segments), kChainsRow)});
  gpu.dispatch("chain_ends", params, {{"Chains", chains}, {"Ends", ends}}, uint(view.size.x + view.size.y));
  gpu.dispatch("backs", params,
               {{"Depth", occluder_depth_of(gbuffer)},
                {"Normal", gbuffer.normal},
                {"Chains", chains},
                {"Ends", ends},
                {"Backs", words}},
               extent_of(view));
  return {words, chains};
}

void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
             const Estimate& out) {
  HorizonParams params{};
  params.view = gbuffer.view;
  params.radius = reach.radius;
  params.falloff_start = reach.falloff_start;
  params.front = reach.front;
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.thickness = reach.thickness;
  params.bias = reach.bias;
  params.plane = out.plane;
  params.curvature = out.curvature.value_or(0);
  params.depth_precision = gbuffer.depth_precision;
  std::vector<gpu::Binding> buffers = buffers_of(gbuffer, out);
  buffers.insert(buffers.end(), {{"Moments", gpu::Optional(out.moments)},
                                 {"Completed", gpu::Optional(out.completed)},
                                 {"Backs", gpu::Optional(out.told)}});
  const uint mode = uint(reach.falloff) | (out.order > 0 ? kWithFirst : 0) | (out.order > 1 ? kWithSecond : 0) |
                    (out.completed ? kWithCompleted : 0) | (out.curvature ? kWithCurvature : 0);
  const uint solid = solid_of(reach, out.told != nullptr) | (reach.in_sectors ? kInSectors : 0);
  const uint sites = out.listed.sites ? 1 : 0;
  std::vector<uint> constants{uint(sampling.slices), uint(sampling.steps), mode, sites, solid};
  gpu.dispatch("horizon", params, buffers, estimate_extent(out.listed), constants);
  if (gbuffer.surfaces == 1) return;
  buffers.push_back({"Hidden", occluder_hidden_of(gbuffer)});
  constants.back() = solid | kHiddenSurface * (gbuffer.surfaces - 1);
  gpu.dispatch("horizon_layers", params, buffers, estimate_extent(out.listed), constants);
}

void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling, Elevation elevation,
          const Estimate& out) {
  HbaoParams params{};
  params.view = gbuffer.view;
  params.radius = reach.radius;
  params.falloff_start = reach.falloff_start;
  params.bias = reach.bias;
  params.from_surface = elevation == Elevation::surface ? 1 : 0;
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.plane = out.plane;
  params.depth_precision = gbuffer.depth_precision;
  gpu.dispatch("hbao", params, buffers_of(gbuffer, out), estimate_extent(out.listed),
               {uint(sampling.slices), uint(sampling.steps), uint(reach.falloff), out.listed.sites ? 1u : 0u});
}

void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
            const EstimatorSettings& settings, const Estimate& out) {
  CrytekParams params{};
  params.view = gbuffer.view;
  params.radius = reach.radius;
  params.bias = reach.bias;
  params.uniform_volume = settings.sample_kernel == SampleKernel::uniform ? 1 : 0;
  params.range_check = range_check_of(settings.range_check);
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.plane = out.plane;
  params.depth_precision = gbuffer.depth_precision;
  gpu.dispatch("crytek", params, buffers_of(gbuffer, out), estimate_extent(out.listed),
               {uint(settings.samples), out.listed.sites ? 1u : 0u});
}

bool searches_quickly(const EstimatorSettings& settings, const GBuffer& gbuffer, uint order, bool with_curvature) {
  const bool is_usual = settings.estimator == Estimator::gtao && settings.falloff == Falloff::none &&
                        settings.thickness == ThicknessKind::automatic && settings.complete == Completion::all &&
                        settings.resolution == Resolution::full && settings.further_radii.empty();
  const bool is_plain = order == 0 && !with_curvature && gbuffer.surfaces == 1 && !gbuffer.occluder_depth;
  return settings.search == SliceSearch::quick && settings.tolerance == 0 && is_adaptive(settings) && is_usual &&
         is_plain;
}

const gpu::Buffer& margin(gpu::Recorder& gpu, const GBuffer& gbuffer) {
  const ivec2 size = gbuffer.view.size;
  const uint beside = 2 * uint(kDepthMargin), width = uint(size.x) + beside, height = uint(size.y) + beside;
  const gpu::Buffer& wide = gpu.buffer("depth with margin", sizeof(float) * width * height);
  gpu.dispatch("margin", MarginParams{gbuffer.view},
               {{"Depth", gbuffer.depth}, {"Normal", gbuffer.normal}, {"Wide", wide}},
               {width * height - uint(size.x) * uint(size.y)});
  return wide;
}

Estimate quick_horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const gpu::Buffer& wide,
                       const FrameInputs& frame, const EstimatorSettings& settings) {
  const Reach reach = reach_of(settings, *settings.radius);
  const Sampling sampling = sampling_of(settings, frame.frame);
  Estimate result{&gpu.buffer("ao", plane_bytes(gbuffer.view))};
  result.listed.site_counts = sites.counts;
  gpu.dispatch(
      "quick_horizon",
      QuickParams{gbuffer.view, sites.grid, reach.radius, reach.bias, gbuffer.grid.origin, sampling.noise_shift,
                  gbuffer.depth_precision},
      {{"Wide", wide}, {"Normal", gbuffer.normal}, {"List", sites.list}, {"Counts", sites.counts}, {"Ao", result.ao}},
      sites.extent, {uint(sampling.slices), uint(sampling.steps)});
  return result;
}

gpu::Buffer* completion(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, const Sites& sites) {
  if (!estimate.completed) return nullptr;
  const View& view = gbuffer.view;
  const gpu::Extent tiles = tile_extent(view);
  gpu::Buffer& sums = gpu.buffer("completion", sizeof(vec2) * tiles.x * tiles.y);
  gpu.dispatch("completion", CompletionParams{view, sites.origin, sites.spacing, planes_in(*estimate.ao, view) - 1},
               {{"Depth", gbuffer.depth}, {"Ao", estimate.ao}, {"Completed", estimate.completed}, {"Sums", sums}},
               tiles);
  return &sums;
}

}  // namespace alcove
