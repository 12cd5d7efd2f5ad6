// The passes that smooth the visibility, each surface by itself, and bring it to all pixels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/chain/estimate/estimate.h"

namespace alcove {

/// The visibility on its way through the filters.
struct Visibility {
  gpu::Buffer* ao = nullptr;      // a plane; of several radii the mean
  gpu::Buffer* scales = nullptr;  // a plane for each radius; null: there is one radius, or nobody asked for them
  gpu::Buffer* bent = nullptr;    // planes x, y, z of the mean open direction; null: nobody asked for it
};

/// Takes the mean over the radii of an estimate, and keeps their planes where `keeps_scales`.
Visibility combine(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, bool keeps_scales);

/// What the settings ask of the denoiser.
struct Denoiser {
  std::vector<double> weights;  // from the centre outwards, up to a common factor; empty: there is no filter
  double depth_sigma;           // see EstimatorSettings::denoise_depth_sigma
  // of interpolate's parabola, at d pixels 1 - d^2 times this of what it is at 0; 0: the weights are the user's
  double narrowness;
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
/// Lists where the filters have work, and writes their results everywhere else. `gbuffer` is that of the estimate.
/// Where a list would not pay, there is none.
FilterRuns dilate(gpu::Recorder& gpu, const GBuffer& gbuffer, const TileList& tiles, const Denoiser& denoiser);

/// Runs both directions of the filter on any number of planes, or returns the input where there is no filter. `gbuffer`
/// is that of the estimate. `runs`: from dilate, for the same visibility; without them the filter runs everywhere.
/// `prefix` stands before the names of its buffers where others are filtered too.
gpu::Buffer& denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Denoiser& denoiser,
                     const std::string& prefix = "", const FilterRuns& runs = {});

Visibility denoise(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Denoiser& denoiser,
                   const FilterRuns& runs = {});

/// Gives every pixel a visibility from the sites about it, where not every pixel is one.
Visibility interpolate(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, const Sites& sites,
                       const Denoiser& denoiser, const FilterRuns& runs = {});
gpu::Buffer& interpolate(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const Sites& sites,
                         const Denoiser& denoiser, const std::string& prefix = "", const FilterRuns& runs = {});

/// Brings any number of planes from the blocks of `low` to the pixels of `gbuffer`, or returns the input where both are
/// the same.
Visibility upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, const Visibility& visibility,
                    const FilterRuns& runs = {});
gpu::Buffer& upsample(gpu::Recorder& gpu, const GBuffer& gbuffer, const GBuffer& low, gpu::Buffer& planes,
                      const std::string& prefix = "", const FilterRuns& runs = {});

}  // namespace alcove
