// The passes that smooth the visibility, each surface by itself, and bring it to all pixels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/chain/estimate/estimate.h"

namespace alcove {

/// Takes the mean over the radii of an estimate, and keeps their planes where `keeps_scales`.
Visibility combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, bool keeps_scales);

/// The reach of the bilateral denoiser to each side, in pixels of the estimate. The default is 8 if pixels share
/// estimates, and 4 if each has its own or fit_sites smooths them first.
int denoise_radius_of(const EstimatorSettings& settings);

/// The reach of estimates beyond their own pixels, in px of the frame: of fit_sites and the denoiser, of upsampling
/// (two pixels of the estimate), and of the choice of a tile's directions.
int filter_reach_of(const EstimatorSettings& settings);

/// The parameters of the denoiser.
struct Denoiser {
  std::vector<double> weights;  // from the centre outwards, up to a common factor; empty: there is no filter
  double depth_sigma;           // see EstimatorSettings::denoise_depth_sigma
  int radius;                   // px: see denoise_radius_of()
  bool looks_up;                // the weights are the user's, else interpolate's parabola
  bool fits_sites;              // sites are smoothed among themselves first: see fit_sites.comp
  double within;                // scene units: the largest reach of interpolate and fit_sites
  /// The reach of all filters together, in px.
  int reach() const;
};
Denoiser denoiser_of(const EstimatorSettings& settings);

/// Runs or groups of pixels in which a filter has work; see dilate.comp.
struct RunList {
  gpu::Buffer* runs = nullptr;  // null: all
  gpu::Buffer* counts = nullptr;
};
struct FilterRuns {
  RunList rows;     // of denoise or interpolate
  RunList columns;  // of the same
  RunList blocks;   // of upsample
};
/// Lists the runs and blocks in which the filters have work, and writes their results everywhere else. `gbuffer` is
/// that of the estimate. A list that would not pay is left out.
FilterRuns dilate(gpu::Recorder& gpu, const GBuffer& gbuffer, const TileList& tiles, const Denoiser& denoiser);

/// Runs both directions of the filter on any number of planes, or returns the input without a filter. `gbuffer` is that
/// of the estimate. `runs`: from dilate, for the same visibility; without them the filter runs everywhere. `prefix`
/// stands before the names of its buffers if others are filtered too.
gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Denoiser& denoiser,
                     const std::string& prefix = "", const FilterRuns& runs = {});

Visibility denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Denoiser& denoiser,
                   const FilterRuns& runs = {});

/// Smooths the visibility of the sites of the widest lattice among themselves: planes of the lattice's pixels. No
/// planes if the denoiser does not fit sites.
Visibility fit_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Sites& sites,
                     const Denoiser& denoiser);
gpu::Buffer& fit_sites(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Sites& sites,
                       const Denoiser& denoiser, const std::string& prefix = "");

/// Gives every pixel a visibility from the sites around it, unless every pixel is one. `fitted`: from fit_sites, for
/// the same visibility.
Visibility interpolate(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility,
                       const Visibility& fitted, const Sites& sites, const Denoiser& denoiser,
                       const FilterRuns& runs = {});
gpu::Buffer& interpolate(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const gpu::Buffer* fitted,
                         const Sites& sites, const Denoiser& denoiser, const std::string& prefix = "",
                         const FilterRuns& runs = {});

/// `smooth` with the moments of that order, and curvature, of every pixel, from those of the sites around it; unchanged
/// without moments, or if every pixel is a site.
Visibility spread(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& noisy, const Visibility& fitted,
                  const Sites& sites, Visibility smooth, uint order);

/// Brings any number of planes from the blocks of `low` to the pixels of `gbuffer`, or returns the input if both are
/// the same.
Visibility upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const Visibility& visibility,
                    const FilterRuns& runs = {});
gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, gpu::Buffer& planes,
                      const std::string& prefix = "", const FilterRuns& runs = {});

}  // namespace alcove
