// Host side of the kernels that choose and list the pixels with an estimate of their own.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/sites.h"

#include <array>
#include <bit>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "kernels/estimate/estimate.h"

namespace alcove {
namespace {

/// The shifts of a lattice of one pixel of 4 x 4: those that follow each other lie far apart.
constexpr std::array<ivec2, 16> kShifts{{{0, 0},
                                         {2, 2},
                                         {2, 0},
                                         {0, 2},
                                         {1, 1},
                                         {3, 3},
                                         {3, 1},
                                         {1, 3},
                                         {1, 0},
                                         {3, 2},
                                         {3, 0},
                                         {1, 2},
                                         {0, 1},
                                         {2, 3},
                                         {2, 1},
                                         {0, 3}}};

/// A site stands for pixels within this part of the smallest radius.
constexpr double kStoodFor = 0.2;

/// The pixels of a block that lie on the lattice of a spacing: see tiles.glsl. That of spacing 16 has the one that is
/// first in sites.comp.
constexpr ivec2 kFirst{1, 1};
uint lattice_of(int spacing) {
  constexpr std::array<uint, 5> kLattice{0xffff, 0xa5a5, 0xa0a0, 0x00a0, 0x0020};
  return kLattice.at(std::size_t(std::countr_zero(unsigned(spacing))));
}

}  // namespace

int spacing_of(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return 1;
  if (settings.stride > 0) return settings.stride;
  if (settings.denoise != Denoise::bilateral || settings.resolution != Resolution::full) return 1;
  if (settings.density != Density::uniform && searches_slices(settings)) return 16;
  return settings.slices <= 2 && settings.estimator == Estimator::gtao ? 4 : 1;
}

bool is_adaptive(const EstimatorSettings& settings) {
  return settings.density != Density::uniform && searches_slices(settings) && spacing_of(settings) > 1;
}

int site_reach_of(const EstimatorSettings& settings) {
  return is_adaptive(settings) ? int(settings.resolution) * kSiteReach : 0;
}

SiteRule site_rule_of(const EstimatorSettings& settings, int turn) {
  const bool adapts = is_adaptive(settings);
  return {spacing_of(settings),
          adapts,
          kShifts[std::size_t(turn) % kShifts.size()],
          !settings.no_skip,
          settings.radius ? kStoodFor * radii_of(settings).front() : HUGE_VAL,
          adapts && settings.density == Density::edges};
}

std::size_t site_bytes(const SiteGrid& grid, std::size_t value) {
  return value * kBlock * kBlock * std::size_t(grid.blocks.x) * std::size_t(grid.blocks.y);
}

Sites sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule, const std::string& prefix,
            const gpu::Buffer* wide) {
  if (rule.spacing == 1) return {};
  const View& view = gbuffer.view;
  const ivec2 begin{gbuffer.grid.origin.x + rule.shift.x, gbuffer.grid.origin.y + rule.shift.y};
  const ivec2 overhang{begin.x & (kBlock - 1), begin.y & (kBlock - 1)};
  Sites sites;
  sites.grid = {
      overhang,
      {int(groups_of(view.size.x + overhang.x, uint(kBlock))), int(groups_of(view.size.y + overhang.y, uint(kBlock)))}};
  sites.spacing = rule.spacing;
  sites.origin = {begin.x - kFirst.x, begin.y - kFirst.y};
  const ivec2 blocks = sites.grid.blocks;
  sites.words = &gpu.buffer(prefix + "sites", sizeof(uint) * std::size_t(blocks.x) * std::size_t(blocks.y));
  if (rule.is_adaptive)
    sites.planes = &gpu.buffer(prefix + "planes of sites", site_bytes(sites.grid, 4 * sizeof(float)));
  sites.list = &gpu.buffer(prefix + "sites of blocks", plane_bytes(view));
  sites.counts = &gpu.buffer(prefix + "block site counts", sizeof(SiteCounts));
  sites.extent = listed_extent(*sites.counts, groups_of(int(pixels_of(view)), kGroupX * kGroupY));
  const gpu::Buffer* needed = rule.skips ? gbuffer.needed : nullptr;
  gpu.clear(*sites.counts);
  gpu.dispatch(
      "sites",
      SitesParams{view, sites.grid, lattice_of(rule.spacing), float(rule.within / double(view.tangent_per_pixel.x))},
      {{"Depth", gbuffer.depth},
       {"Normal", gbuffer.normal},
       {"Needed", gpu::Optional(needed)},
       {"Wide", gpu::Optional(wide)},
       {"Blocks", sites.words},
       {"Planes", gpu::Optional(sites.planes)},
       {"List", sites.list},
       {"Counts", sites.counts}},
      {uint(blocks.x), uint(blocks.y)},
      {needed ? 1u : 0u, rule.is_adaptive ? 1u : 0u, wide ? 1u : 0u, rule.edges ? 1u : 0u});
  return sites;
}

void list_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, TileList& list,
                const std::string& prefix) {
  if (!sites.words) return;
  const View& view = gbuffer.view;
  const gpu::Extent tiles = tile_extent(view);
  list.sites = &gpu.buffer("listed sites", std::size_t(tiles.x) * tiles.y * kTile * kTile * sizeof(uint));
  list.site_counts = &gpu.buffer(prefix + "site counts", sizeof(SiteCounts));
  gpu.clear(*list.site_counts);
  gpu.dispatch("list_sites", ListSitesParams{view.size, sites.grid, sites.origin},
               {{"Blocks", sites.words},
                {"Tiles", list.tiles},
                {"TileCountsBuffer", list.counts},
                {"List", list.sites},
                {"Counts", list.site_counts}},
               list_extent(list));
}

}  // namespace alcove
