// The quick search: a few sites of each block of 4 x 4 pixels, in five passes, with fewer rules than `horizon`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/filters/filters.h"
#include "kernels/quick/quick.h"

namespace alcove {

/// Whether settings ask for the quick search, and for nothing that it lacks: several radii, a falloff, a given
/// thickness, surfaces that are not completed everywhere, a smaller resolution, other densities and denoisers.
bool may_search_quickly(const EstimatorSettings& settings);
/// Whether the quick search computes a frame: not with moments, hidden surfaces, or surfaces that do not block. Callers
/// exclude curvature, which it does not find.
bool searches_quickly(const EstimatorSettings& settings, const GBuffer& gbuffer, uint order);

/// Blocks of pixels, and their sites.
struct Blocks {
  BlocksParams params;                  // of all kernels of the quick search
  const gpu::Buffer* words = nullptr;   // one uint per block: see blocks.glsl
  const gpu::Buffer* planes = nullptr;  // vec4 by the sites' numbers
  const gpu::Buffer* list = nullptr;    // of the sites' numbers
  gpu::Buffer* counts = nullptr;        // one SiteCounts
  const gpu::Buffer* wide = nullptr;    // the depth with a margin
  gpu::Extent sites = 0;                // the workgroups over the list
};

/// Chooses the sites, and copies the depth into a plane with a margin.
Blocks block_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings,
                   const FrameInputs& frame);
/// Makes the margin of the depth.
void margin(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks);
/// The visibility of the sites.
const gpu::Buffer& quick_horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks,
                                 const Sampling& sampling);
/// The same, smoothed among the sites.
const gpu::Buffer& fit_blocks(gpu::Recorder& gpu, const Blocks& blocks, const gpu::Buffer& seen);
/// The visibility of all pixels.
gpu::Buffer& spread_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks, const gpu::Buffer& fitted);

/// The sites and their visibility, for debug views.
struct ShownBlocks {
  Sites sites;
  const gpu::Buffer* ao;  // a plane
};
ShownBlocks show_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const Blocks& blocks, const gpu::Buffer& seen);

}  // namespace alcove
