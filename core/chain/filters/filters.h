// The passes that smooth the visibility, each surface by itself, and bring it to all pixels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/chain/estimate/estimate.h"

namespace alcove {

/// Takes the mean over the radii, each a plane of `of_radii.ao`, and keeps these planes if `keeps_scales`.
Visibility combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& of_radii, bool keeps_scales);

/// The reach of the bilateral denoiser to each side, in pixels of the estimate. The default is 8 if pixels share
/// estimates, and 4 if each has its own. Blocks of sites have their own reach: see Denoiser.
int denoise_radius_of(const EstimatorSettings& settings);

/// The reach of estimates beyond their own pixels, in px of the frame: of the denoiser, of upsampling (two pixels of
/// the estimate), and of the choice of a tile's directions.
int filter_reach_of(const EstimatorSettings& settings);

/// The parameters of the denoiser.
struct Denoiser {
  /// Of the blocks of sites: see fit_blocks.comp and spread_blocks.comp.
  struct OfBlocks {
    float most;   // px: from how far a site takes others at most
    float held;   // px^2: by which slopes are held back
    float slope;  // the part of them that pixels follow
  };

  std::vector<double> weights;  // from the centre outwards, up to a common factor; empty: there is no filter by pixels
  double depth_sigma;           // see EstimatorSettings::denoise_depth_sigma
  int radius;                   // px: see denoise_radius_of()
  bool looks_up;                // the weights are the user's, else interpolate's parabola
  /// For adaptive sites at a spacing of 16, without a radius or weights of the user's.
  std::optional<OfBlocks> of_blocks;
  /// Scene units, by radius from the smallest on: the largest reach of fit_blocks. That of interpolate is the first.
  std::vector<double> within;
  bool smooths() const { return !weights.empty() || of_blocks; }
  /// The reach of all filters together, in px.
  int reach() const;
};
Denoiser denoiser_of(const EstimatorSettings& settings);

/// Smooths any number of planes, each surface by itself, and brings them from sites to all pixels; returns the input
/// without a filter. `gbuffer` is that of the estimate. `prefix` stands before the names of its buffers if others are
/// smoothed too. The first `moments` planes are moments.
gpu::Buffer& smooth(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Sites& sites,
                    const Denoiser& denoiser, const std::string& prefix = "", uint moments = 0);
/// The same for all planes of a visibility, which has moments of that order, and a plane of AO for each radius.
Visibility smooth(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Sites& sites,
                  const Denoiser& denoiser, uint order = 0);

// Its passes.

/// Both directions of the filter, if every pixel has an estimate.
gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Denoiser& denoiser,
                     const std::string& prefix = "");

/// Gives every pixel a visibility from the sites around it, by the reach and the weights of the settings.
gpu::Buffer& interpolate(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Sites& sites,
                         const Denoiser& denoiser, const std::string& prefix = "", uint moments = 0);

/// Smooths planes at sites among themselves: see fit_blocks.comp. A plane for each radius reaches as far as that radius
/// lets it, moments alone as far as the largest one does, and all others as far as the smallest one.
const gpu::Buffer& fit_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& planes, const Sites& sites,
                              const Denoiser& denoiser, const std::string& prefix = "", uint moments = 0);
/// Gives every pixel the values of the sites around it. The first so many planes are moments.
gpu::Buffer& spread_blocks(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& fitted, const Sites& sites,
                           const Denoiser& denoiser, const std::string& prefix = "", uint moments = 0);

/// Brings any number of planes from the blocks of `low` to the pixels of `gbuffer`, or returns the input if both are
/// the same.
Visibility upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const Visibility& visibility);
gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, gpu::Buffer& planes,
                      const std::string& prefix = "");

}  // namespace alcove
