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

std::size_t tiles_in(const View& view) {
  return std::size_t(groups_of(view.size.x, uint(kTile))) * groups_of(view.size.y, uint(kTile));
}

std::size_t rows_bytes(const View& view) { return tiles_in(view) * kTile * sizeof(uint); }

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

ivec2 moved_by(const ivec2& origin, const ivec2& shift) { return {origin.x + shift.x, origin.y + shift.y}; }

/// See links.comp.
const gpu::Buffer& flat_links(gpu::Recorder& gpu, const View& view, const std::string& prefix) {
  return gpu.buffer(prefix + "flat links", rows_bytes(view));
}

/// From so many slices on an estimate is meant to be better than what fewer pixels can tell.
constexpr int kManySlices = 5;

}  // namespace

int spacing_of(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return 1;
  if (settings.stride > 0) return settings.stride;
  if (settings.denoise != Denoise::bilateral || settings.resolution != Resolution::full) return 1;
  if (settings.density == Density::adaptive && searches_slices(settings)) return settings.slices < kManySlices ? 16 : 2;
  return settings.slices <= 2 && settings.estimator == Estimator::gtao ? 4 : 1;
}

bool is_adaptive(const EstimatorSettings& settings) {
  return settings.density == Density::adaptive && searches_slices(settings) && spacing_of(settings) > 1;
}

bool fits_sites(const EstimatorSettings& settings) {
  constexpr int kWidest = 16;
  return settings.denoise == Denoise::bilateral && settings.denoise_kernel.empty() && settings.denoise_radius == 0 &&
         settings.denoise_depth_sigma == 0 && is_adaptive(settings) && spacing_of(settings) == kWidest;
}

int wide_slices_of(const EstimatorSettings& settings) {
  return settings.slices + (fits_sites(settings) ? settings.slices / 2 : 0);
}

int site_reach_of(const EstimatorSettings& settings) {
  return is_adaptive(settings) ? int(settings.resolution) * kSiteReach : 0;
}

SiteRule site_rule_of(const EstimatorSettings& settings, int turn) {
  return {spacing_of(settings), is_adaptive(settings), kShifts[std::size_t(turn) % kShifts.size()]};
}

Sites sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule, const std::string& prefix) {
  if (rule.spacing == 1) return {};
  const View& view = gbuffer.view;
  const gpu::Buffer* rows = &links(gpu, gbuffer, rule, prefix);
  const gpu::Extent strips{groups_of(view.size.x, uint(kTile * kSitesTiles)), groups_of(view.size.y, uint(kTile))};
  for (int spacing = rule.spacing / 2; rule.is_adaptive && spacing > 0; spacing /= 2) {
    // Each pass reads what the one before it wrote.
    const bool is_odd = std::countr_zero(unsigned(rule.spacing / spacing)) % 2 == 1;
    gpu::Buffer& more = gpu.buffer(prefix + (is_odd ? "more sites" : "sites"), rows_bytes(view));
    // On the denser lattices a path may lead over round surfaces.
    const gpu::Buffer& links = spacing >= 4 ? flat_links(gpu, view, prefix) : *rows;
    gpu.dispatch("sites", SitesParams{view.size, moved_by(gbuffer.grid.origin, rule.shift), spacing},
                 {{"Rows", rows}, {"Links", links}, {"Result", more}}, strips);
    rows = &more;
  }
  return {rows, rule.spacing, rule.shift};
}

const gpu::Buffer& links(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule, const std::string& prefix) {
  const View& view = gbuffer.view;
  gpu::Buffer& rows = gpu.buffer(prefix + "sites", rows_bytes(view));
  gpu.dispatch("links", LinksParams{view, moved_by(gbuffer.grid.origin, rule.shift)},
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Rows", rows},
                {"Flat", gpu::Optional(rule.is_adaptive ? &flat_links(gpu, view, prefix) : nullptr)}},
               {groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))},
               {uint(rule.spacing), rule.is_adaptive ? 1u : 0u});
  return rows;
}

void list_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, TileList& list,
                const std::string& prefix) {
  if (!sites.rows) return;
  const View& view = gbuffer.view;
  list.sites = &gpu.buffer("listed sites", tiles_in(view) * kTile * kTile * sizeof(uint));
  list.site_counts = &gpu.buffer(prefix + "site counts", sizeof(SiteCounts));
  gpu.clear(*list.site_counts);
  gpu.dispatch("list_sites", ListSitesParams{view.size, moved_by(gbuffer.grid.origin, sites.shift)},
               {{"Rows", sites.rows},
                {"Tiles", list.tiles},
                {"TileCountsBuffer", list.counts},
                {"List", list.sites},
                {"Counts", list.site_counts}},
               list_extent(list));
}

}  // namespace alcove
