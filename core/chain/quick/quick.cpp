// Host side of the kernels of the quick search.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/quick/quick.h"

#include <algorithm>

#include "core/chain/base/planes.h"

namespace alcove {
namespace {

BlocksParams params_of(const GBuffer& gbuffer, const EstimatorSettings& settings, const FrameInputs& frame) {
  const View& view = gbuffer.view;
  const ivec2 shift = site_rule_of(settings, frame.turn).shift, origin = gbuffer.grid.origin;
  const Reach reach = reach_of(settings, *settings.radius);
  BlocksParams params{};
  params.view = view;
  params.overhang = {(origin.x + shift.x) & (kBlock - 1), (origin.y + shift.y) & (kBlock - 1)};
  params.blocks = {int(groups_of(view.size.x + params.overhang.x, uint(kBlock))),
                   int(groups_of(view.size.y + params.overhang.y, uint(kBlock)))};
  params.reach = float(denoiser_of(settings).within / double(view.tangent_per_pixel.x));
  params.radius = reach.radius;
  params.bias = reach.bias;
  params.noise_origin = origin;
  params.noise_shift = sampling_of(settings, frame.frame).noise_shift;
  params.depth_precision = gbuffer.depth_precision;
  return params;
}

/// Bytes of a value for each site that there may be.
std::size_t site_bytes(const BlocksParams& params, std::size_t value) {
  return value * kBlockSites * std::size_t(params.blocks.x) * std::size_t(params.blocks.y);
}

}  // namespace

bool may_search_quickly(const EstimatorSettings& settings) {
  const bool is_usual = settings.falloff == Falloff::none && settings.thickness == ThicknessKind::automatic &&
                        settings.complete == Completion::all && settings.resolution == Resolution::full;
  return settings.search == SliceSearch::quick && settings.estimator == Estimator::gtao && settings.tolerance == 0 &&
         is_usual && settings.further_radii.empty() && fits_sites(settings);
}

bool searches_quickly(const EstimatorSettings& settings, const GBuffer& gbuffer, uint order) {
  return may_search_quickly(settings) && order == 0 && gbuffer.surfaces == 1 && !gbuffer.occluder_depth;
}

Blocks block_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings,
                   const FrameInputs& frame) {
  const View& view = gbuffer.view;
  const auto wide = [](int px) { return std::size_t(px) + 2 * kDepthMargin; };
  Blocks blocks;
  blocks.params = params_of(gbuffer, settings, frame);
  blocks.words = &gpu.buffer("blocks", site_bytes(blocks.params, sizeof(uint)) / kBlockSites);
  blocks.planes = &gpu.buffer("planes of sites", site_bytes(blocks.params, 4 * sizeof(float)));
  blocks.list = &gpu.buffer("sites of blocks", site_bytes(blocks.params, sizeof(uint)));
  blocks.counts = &gpu.buffer("site counts", sizeof(SiteCounts));
  blocks.wide = &gpu.buffer("depth with margin", sizeof(float) * wide(view.size.x) * wide(view.size.y));
  const uint most = groups_of(blocks.params.blocks.x * blocks.params.blocks.y * kBlockSites, kGroupX * kGroupY);
  blocks.sites = {*blocks.counts, std::min(most, kListedRow), groups_of(int(most), kListedRow)};
  const gpu::Buffer* needed = settings.no_skip ? nullptr : gbuffer.needed;
  gpu.clear(*blocks.counts);
  gpu.dispatch("block_sites", blocks.params,
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Needed", gpu::Optional(needed)},
                {"Wide", blocks.wide},
                {"Blocks", blocks.words},
                {"Planes", blocks.planes},
                {"List", blocks.list},
                {"Counts", blocks.counts}},
               {uint(blocks.params.blocks.x), uint(blocks.params.blocks.y)}, {needed ? 1u : 0u});
  return blocks;
}

void margin(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks) {
  const uint beside = 2 * uint(kDepthMargin);
  gpu.dispatch("margin", blocks.params, {{"Depth", gbuffer.depth}, {"Normal", gbuffer.normal}, {"Wide", blocks.wide}},
               {beside * (beside + uint(gbuffer.view.size.x) + uint(gbuffer.view.size.y))});
}

const gpu::Buffer& quick_horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks,
                                 const Sampling& sampling) {
  const gpu::Buffer& seen = gpu.buffer("seen of blocks", site_bytes(blocks.params, sizeof(float)));
  gpu.dispatch("quick_horizon", blocks.params,
               {{"Wide", blocks.wide},
                {"Normal", gbuffer.normal},
                {"Blocks", blocks.words},
                {"List", blocks.list},
                {"Counts", blocks.counts},
                {"Seen", seen}},
               blocks.sites, {uint(sampling.slices), uint(sampling.steps)});
  return seen;
}

const gpu::Buffer& fit_blocks(gpu::Recorder& gpu, const Blocks& blocks, const gpu::Buffer& seen) {
  const gpu::Buffer& fitted = gpu.buffer("fitted blocks", site_bytes(blocks.params, 4 * sizeof(float)));
  gpu.dispatch("fit_blocks", blocks.params,
               {{"Blocks", blocks.words},
                {"Planes", blocks.planes},
                {"List", blocks.list},
                {"Counts", blocks.counts},
                {"Seen", seen},
                {"Fitted", fitted}},
               blocks.sites);
  return fitted;
}

gpu::Buffer& spread_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks,
                           const gpu::Buffer& fitted) {
  gpu::Buffer& ao = gpu.buffer("denoised", plane_bytes(gbuffer.view));
  gpu.dispatch("spread_blocks", blocks.params,
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Blocks", blocks.words},
                {"Planes", blocks.planes},
                {"Fitted", fitted},
                {"Ao", ao}},
               {2 * uint(blocks.params.blocks.x), 2 * uint(blocks.params.blocks.y)});
  return ao;
}

ShownBlocks show_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks, const gpu::Buffer& seen) {
  const View& view = gbuffer.view;
  const gpu::Extent tiles{groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
  const gpu::Buffer& rows = gpu.buffer("rows of blocks", sizeof(uint) * kTile * tiles.x * tiles.y);
  const gpu::Buffer& ao = gpu.buffer("ao", plane_bytes(view));
  gpu.dispatch("show_blocks", blocks.params, {{"Blocks", blocks.words}, {"Seen", seen}, {"Rows", rows}, {"Ao", ao}},
               {tiles.x, uint(view.size.y)});
  return {{&rows, kBlock * kBlock, {}}, &ao};
}

}  // namespace alcove
