// The choice of the pixels with an estimate of their own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"
#include "core/chain/geometry/geometry.h"

namespace alcove {

/// The number of pixels per estimate, with adaptive density the largest: 1, 2, 4, 8 or 16. The default is 1 unless the
/// bilateral denoiser runs at full resolution. Then it is 16 for an adaptive density, or 2 from 5 slices on, and 4 with
/// up to 2 slices for gtao with a uniform one.
int spacing_of(const EstimatorSettings& settings);

/// Whether surfaces of few pixels have more estimates than by spacing_of().
bool is_adaptive(const EstimatorSettings& settings);

/// Whether the sites of the widest lattice are smoothed among themselves before interpolation: see fit_sites.comp.
bool fits_sites(const EstimatorSettings& settings);

/// The slices of a site of the widest lattice: more than of others, since it stands for the pixels around it.
int wide_slices_of(const EstimatorSettings& settings);

/// The reach of the choice of sites, in px of the frame: see sites.comp.
int site_reach_of(const EstimatorSettings& settings);

/// The sites of a G-buffer: pixels with an estimate; filters give it to the others.
struct Sites {
  const gpu::Buffer* rows = nullptr;  // 8 words per tile, see tiles.glsl; null: every pixel has an estimate
  int spacing = 1;                    // at least one of so many pixels is a site
  ivec2 shift{};                      // px of their lattice to the left and up
};

/// The rule by which sites are chosen.
struct SiteRule {
  int spacing;       // at least one of so many pixels is a site: 1, 2, 4, 8 or 16
  bool is_adaptive;  // more where a surface is too small or too bent for its neighbours' sites
  ivec2 shift{};     // px of the lattice to the left and up
};
/// `turn`: averaged frames have different ones, from 0 on, and with it different shifts.
SiteRule site_rule_of(const EstimatorSettings& settings, int turn = 0);

/// Chooses the sites, from the G-buffer alone.
/// `prefix` stands before the names of its buffers if there is another estimate.
Sites sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule, const std::string& prefix = "");

/// Links neighbours of one surface, and makes the pixels of the widest lattice sites: see links.comp.
const gpu::Buffer& links(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule,
                         const std::string& prefix = "");

struct TileList;
/// Lists the sites of the listed tiles, for the estimators. `prefix` stands before the names of its buffers.
void list_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, TileList& list,
                const std::string& prefix = "");

}  // namespace alcove
