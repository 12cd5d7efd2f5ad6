// Which pixels have an estimate of their own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"
#include "core/chain/geometry/geometry.h"

namespace alcove {

/// How many pixels share one estimate, at most where the density is adaptive: 1, 2, 4, 8 or 16. Where the settings
/// leave it open, it is 1 unless the bilateral denoiser gives the others theirs at full resolution. Then it is 16, or 2
/// from 5 slices on, for an adaptive density, and 4 with up to 2 slices for gtao with a uniform one.
int spacing_of(const EstimatorSettings& settings);

/// Whether surfaces that show few pixels have more estimates than spacing_of() says.
bool is_adaptive(const EstimatorSettings& settings);

/// Whether the sites of the widest lattice are smoothed among themselves before others take their estimates: see
/// fit_sites.comp.
bool fits_sites(const EstimatorSettings& settings);

/// The slices of a site of the widest lattice: more than of others, where it stands for the pixels about it.
int wide_slices_of(const EstimatorSettings& settings);

/// The reach of depths that decide where estimates are made, in px of the frame: see sites.comp.
int site_reach_of(const EstimatorSettings& settings);

/// The sites of a G-buffer: pixels with an estimate, from which the filters make that of the others.
struct Sites {
  const gpu::Buffer* rows = nullptr;  // 8 words per tile, see tiles.glsl; null: every pixel has an estimate
  int spacing = 1;                    // one pixel of so many is a site at least
  ivec2 shift{};                      // px of their lattice to the left and up
};

/// The rule by which sites are chosen.
struct SiteRule {
  int spacing;       // one pixel of so many is a site at least: 1, 2, 4, 8 or 16
  bool is_adaptive;  // more where a surface is too small or too bent for its neighbours' sites
  ivec2 shift{};     // px of the lattice to the left and up
};
/// `turn`: of frames whose sites are taken together each has its own, from 0 on, and with it another shift.
SiteRule site_rule_of(const EstimatorSettings& settings, int turn = 0);

/// Chooses the sites, from the G-buffer alone.
/// `prefix` stands before the names of its buffers where there is another estimate.
Sites sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule, const std::string& prefix = "");

/// Says which neighbours show one surface, and makes the pixels of the widest lattice sites: see links.comp.
const gpu::Buffer& links(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule,
                         const std::string& prefix = "");

struct TileList;
/// Lists the sites of the listed tiles, for the estimators. `prefix` stands before the names of its buffers.
void list_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, TileList& list,
                const std::string& prefix = "");

}  // namespace alcove
