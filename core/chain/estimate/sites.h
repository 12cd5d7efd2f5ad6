// The choice of sites: the pixels with an estimate of their own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "core/base/settings.h"
#include "core/chain/geometry/geometry.h"
#include "kernels/base/shared.h"

namespace alcove {

/// The number of pixels per estimate, with adaptive density the largest: 1, 2, 4, 8 or 16. The default is 1 unless the
/// bilateral denoiser runs at full resolution. Then it is 16 for an adaptive density, and 4 with up to 2 slices for
/// gtao with a uniform one.
int spacing_of(const EstimatorSettings& settings);

/// Whether each surface in a block of 4 x 4 pixels has an estimate, however few pixels it has there.
bool is_adaptive(const EstimatorSettings& settings);

/// The reach of the choice of sites, in px of the frame.
int site_reach_of(const EstimatorSettings& settings);

/// The sites of a G-buffer; filters give their estimates to the other pixels.
struct Sites {
  const gpu::Buffer* words = nullptr;  // one uint per block, see blocks.glsl; null: every pixel has an estimate
  SiteGrid grid{};
  const gpu::Buffer* planes = nullptr;  // a vec4 per site, see likeness.glsl; null unless they are adaptive
  const gpu::Buffer* list = nullptr;    // of their pixels
  gpu::Buffer* counts = nullptr;        // one SiteCounts
  gpu::Extent extent = 0;               // the workgroups over the list
  int spacing = 1;                      // at least one of so many pixels is a site
  ivec2 origin{};                       // px from the corner of lattices to the image's
};

/// The bytes of so many for each site that there may be.
std::size_t site_bytes(const SiteGrid& grid, std::size_t value);

/// The rule by which sites are chosen.
struct SiteRule {
  int spacing;               // at least one of so many pixels is a site: 1, 2, 4, 8 or 16
  bool is_adaptive;          // more if a block shows a surface without one
  ivec2 shift{};             // px of the blocks to the left and up
  bool skips = true;         // blocks without needed estimates have none
  double within = HUGE_VAL;  // scene units: a site stands for no pixel farther away
  bool edges = false;        // many beside edges of depth; only if adaptive
};
/// `turn`: averaged frames have different ones, from 0 on, and with it different shifts.
SiteRule site_rule_of(const EstimatorSettings& settings, int turn = 0);

/// Chooses the sites, from the G-buffer alone. If `wide` is not null, it copies the depth into its middle: see
/// margin(). `prefix` stands before the names of its buffers if there is another estimate.
Sites sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const SiteRule& rule, const std::string& prefix = "",
            const gpu::Buffer* wide = nullptr);

struct TileList;
/// Lists the sites of the listed tiles, for the estimators. `prefix` stands before the names of its buffers.
void list_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, TileList& list,
                const std::string& prefix = "");

}  // namespace alcove
