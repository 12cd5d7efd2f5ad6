// Host side of the estimators, and of what they leave out.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/estimator_facts.h"
#include "core/chain/base/pass_common.h"
#include "core/chain/estimate/sites.h"
#include "kernels/estimate/estimate.h"
#include "kernels/estimate/exact_search.h"

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

/// What is completed, as kernels take it.
uint completion_of(const Reach& reach) {
  switch (reach.complete) {
    case Completion::none: break;
    case Completion::border: return kCompletesBorder;
    case Completion::all: return kCompletesBorder | (completes_behind(reach) ? kCompletesHidden : 0u);
  }
  return 0;
}

/// Tiles in x and y.
gpu::Extent tile_extent(const View& view) {
  return {groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
}

/// Blocks of tiles in x and y.
gpu::Extent block_extent(const View& view) {
  return {groups_of(view.size.x, uint(kTile * kTileBlock)), groups_of(view.size.y, uint(kTile * kTileBlock))};
}

/// The buffers that all estimators take, but for those of the exact search.
std::vector<gpu::Binding> buffers_of(const GBuffer& gbuffer, const Estimate& out) {
  return {{"Depth", gbuffer.depth},    {"Occluders", occluder_depth_of(gbuffer)},
          {"Normal", gbuffer.normal},  {"Ao", out.ao},
          {"List", out.listed.tiles},  {"Counts", out.listed.counts},
          {"Sites", out.listed.sites}, {"SiteCountsBuffer", out.listed.site_counts}};
}

}  // namespace

gpu::Extent estimate_extent(const TileList& list) {
  if (!list.sites) return list_extent(list);
  const uint most = groups_of(int(list.sites->bytes() / sizeof(uint)), kGroupX * kGroupY);
  return {*list.site_counts, std::min(most, kListedRow), groups_of(int(most), kListedRow)};
}

gpu::Extent list_extent(const TileList& list) {
  const auto most = uint(list.tiles->bytes() / sizeof(uint));
  return {*list.counts, std::min(most, kListedRow), groups_of(most, kListedRow)};
}

Reach reach_of(const EstimatorSettings& settings, double radius) {
  // Crytek's samples fill the sphere of the radius whatever the falloff.
  const double end = settings.estimator == Estimator::crytek ? 1 : settings.falloff_end;
  return {float(radius * end),
          float(radius * settings.falloff_start),
          settings.falloff,
          thickness_of(settings),
          float(settings.bias),
          settings.complete,
          settings.estimator == Estimator::bitmask};
}

bool completes_behind(const Reach& reach) { return reach.complete == Completion::all && !std::isinf(reach.thickness); }

Sampling sampling_of(const EstimatorSettings& settings, int frame) {
  return {settings.slices, settings.steps, noise_shift(settings.noise == Noise::animated ? frame : 0, settings.seed)};
}

int filter_reach_of(const EstimatorSettings& settings) {
  const int denoised = denoise_reach_of(settings);
  const int refined = settings.tolerance > 0 ? kRefineReach : 0;
  return int(settings.resolution) * (denoised + refined + (settings.resolution == Resolution::full ? 0 : 2));
}

int site_reach_of(const EstimatorSettings& settings) {
  return is_adaptive(settings) ? int(settings.resolution) * kSiteReach : 0;
}

Skipping skipping_of(const EstimatorSettings& settings, const FrameInputs& frame, const BlockGrid& grid) {
  return {!settings.no_skip, settings.no_skip ? nullptr : frame.changes,
          without_margin(frame, grid, filter_reach_of(settings))};
}

Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                  const EstimatorSettings& settings, bool with_bent, bool with_completed) {
  const auto radii = radii_of(settings);
  const Sampling sampling = sampling_of(settings, frame.frame);
  const Skipping skipping = skipping_of(settings, frame, gbuffer.grid);
  const SearchDirections directions = search_directions(settings);
  const VolumeSamples volume{settings.samples, settings.sample_kernel, settings.range_check};
  const bool is_exact = searches_exactly(settings);
  Estimate result;
  result.ao = &gpu.buffer("ao", radii.size() * plane_bytes(gbuffer.view));
  gpu::Buffer* bent = with_bent ? &gpu.buffer("bent", 3 * plane_bytes(gbuffer.view)) : nullptr;
  gpu::Buffer* completed = with_completed ? &gpu.buffer("completed", plane_bytes(gbuffer.view)) : nullptr;
  // Tiles that are as in the frame before keep what it found in them.
  if (completed && (is_exact || !skipping.changes)) gpu.clear(*completed);

  const gpu::Buffer* hidden = is_exact ? nullptr : bounds(gpu, gbuffer, skipping);
  for (uint plane = 0; plane < radii.size(); plane++) {
    const Reach reach = reach_of(settings, radii[plane]);
    const bool is_largest = plane + 1 == radii.size();
    Estimate out{result.ao, is_largest ? bent : nullptr};
    out.completed = is_largest ? completed : nullptr;
    result.bent = out.bent;
    result.completed = out.completed;
    if (!is_exact) {
      out.listed = classify(gpu, gbuffer, hidden, skipping, reach.radius, sites, out, plane);
      list_sites(gpu, gbuffer, sites, out.listed);
    }
    result.listed = out.listed;
    switch (settings.estimator) {
      case Estimator::gtao:
      case Estimator::bitmask:
        if (!is_exact) horizon(gpu, gbuffer, reach, sampling, out, plane);
        for (int i = 0; is_exact && settings.tolerance == 0 && i < directions.count; i++) {
          Profile lines = profile(gpu, gbuffer, directions, i, reach);
          complete(gpu, gbuffer, lines, reach);
          exact(gpu, gbuffer, lines, directions, reach, out, plane);
        }
        if (settings.tolerance > 0) {
          Convergence search = convergence(gpu, gbuffer, settings, out, plane, uint(radii.size()));
          for (const int count : kComparedDirections) {
            search_until(gpu, gbuffer, reach, search, count);
            converge(gpu, gbuffer, search, result, count);
            refine(gpu, gbuffer, search, result, count);
          }
        }
        break;
      case Estimator::hbao: hbao(gpu, gbuffer, reach, sampling, settings.elevation, out, plane); break;
      case Estimator::crytek: crytek(gpu, gbuffer, reach, sampling, volume, out, plane); break;
    }
  }
  // What is left out at the largest radius may be computed at another.
  result.listed.skips_surfaces = result.listed.skips_surfaces && radii.size() == 1;
  return result;
}

const gpu::Buffer* bounds(gpu::Recorder& gpu, const GBuffer& gbuffer, const Skipping& skipping) {
  if (!skipping.skips_sky || !gbuffer.hidden) return nullptr;
  const gpu::Extent blocks = block_extent(gbuffer.view);
  gpu::Buffer& result = gpu.buffer("bounds", sizeof(vec2) * blocks.x * blocks.y);
  gpu.dispatch("bounds", BoundsParams{gbuffer.view.size, gbuffer.surfaces - 1},
               {{"Depth", gbuffer.depth}, {"Hidden", gbuffer.hidden}, {"Blocks", result}}, blocks);
  return &result;
}

TileList classify(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer* bounds, const Skipping& skipping,
                  float radius, const Sites& sites, const Estimate& out, uint plane, const std::string& prefix) {
  const gpu::Extent tiles = tile_extent(gbuffer.view);
  const gpu::Extent blocks = block_extent(gbuffer.view);
  TileList list;
  list.tiles = &gpu.buffer("tiles", sizeof(uint) * tiles.x * tiles.y);
  list.counts = &gpu.buffer(prefix + "tile counts", sizeof(TileCounts));
  list.kinds = &gpu.buffer(prefix + "tile kinds", sizeof(uint) * tiles.x * tiles.y);
  const bool selects = skipping.skips_sky && gbuffer.needed;
  list.skips_surfaces = skipping.changes || selects;
  gpu.clear(*list.counts);
  const uint mode = (skipping.skips_sky ? kClassifySkips : 0) | (out.bent ? kClassifyWithBent : 0) |
                    (out.completed ? kClassifyWithCompleted : 0) | (skipping.changes ? kClassifyReuses : 0) |
                    (selects ? kClassifySelects : 0) | (gbuffer.surfaces > 1 ? kClassifyLayered : 0);
  const ClassifyParams params{gbuffer.view,
                              radius,
                              plane,
                              gbuffer.grid.frame_size,
                              gbuffer.grid.overhang,
                              gbuffer.grid.factor,
                              gbuffer.surfaces > 1 ? kHiddenChangeMargin : kChangeMargin,
                              skipping.needed.from,
                              skipping.needed.to};
  gpu.dispatch("classify", params,
               {{"Bounds", bounds},
                {"Changes", skipping.changes},
                {"Needed", gbuffer.needed},
                {"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Rows", sites.rows},
                {"List", list.tiles},
                {"Counts", list.counts},
                {"Kinds", list.kinds},
                {"Ao", out.ao},
                {"Bent", out.bent},
                {"Completed", out.completed}},
               {groups_of(int(blocks.x), kGroupY) * kGroupX, blocks.y * kGroupY}, {sites.rows ? 1u : 0u, mode});
  return list;
}

void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
             const Estimate& out, uint plane) {
  HorizonParams params{};
  params.view = gbuffer.view;
  params.radius = reach.radius;
  params.falloff_start = reach.falloff_start;
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.thickness = reach.thickness;
  params.bias = reach.bias;
  params.plane = plane;
  params.depth_precision = gbuffer.depth_precision;
  std::vector<gpu::Binding> buffers = buffers_of(gbuffer, out);
  buffers.insert(buffers.end(), {{"Bent", out.bent}, {"Completed", out.completed}});
  const uint mode = uint(reach.falloff) | (out.bent ? kWithBent : 0) | (out.completed ? kWithCompleted : 0);
  const uint solid = thickness_rule_of(reach.thickness) | completion_of(reach) | (reach.in_sectors ? kInSectors : 0);
  std::vector<uint> constants{uint(sampling.slices), uint(sampling.steps), mode, out.listed.sites ? 1u : 0u, solid};
  gpu.dispatch("horizon", params, buffers, estimate_extent(out.listed), constants);
  if (gbuffer.surfaces == 1) return;
  buffers.push_back({"Hidden", occluder_hidden_of(gbuffer)});
  constants.back() = solid | kHiddenSurface * (gbuffer.surfaces - 1);
  gpu.dispatch("horizon_layers", params, buffers, estimate_extent(out.listed), constants);
}

void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling, Elevation elevation,
          const Estimate& out, uint plane) {
  HbaoParams params{};
  params.view = gbuffer.view;
  params.radius = reach.radius;
  params.falloff_start = reach.falloff_start;
  params.bias = reach.bias;
  params.from_surface = elevation == Elevation::surface ? 1 : 0;
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.plane = plane;
  params.depth_precision = gbuffer.depth_precision;
  gpu.dispatch("hbao", params, buffers_of(gbuffer, out), estimate_extent(out.listed),
               {uint(sampling.slices), uint(sampling.steps), uint(reach.falloff), out.listed.sites ? 1u : 0u});
}

void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
            const VolumeSamples& samples, const Estimate& out, uint plane) {
  CrytekParams params{};
  params.view = gbuffer.view;
  params.radius = reach.radius;
  params.bias = reach.bias;
  params.uniform_volume = samples.kernel == SampleKernel::uniform ? 1 : 0;
  params.range_check = range_check_of(samples.range_check);
  params.noise_origin = gbuffer.grid.origin;
  params.noise_shift = sampling.noise_shift;
  params.plane = plane;
  params.depth_precision = gbuffer.depth_precision;
  gpu.dispatch("crytek", params, buffers_of(gbuffer, out), estimate_extent(out.listed),
               {uint(samples.count), out.listed.sites ? 1u : 0u});
}

}  // namespace alcove
