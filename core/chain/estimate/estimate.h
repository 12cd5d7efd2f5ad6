// The estimators, the passes that list the tiles they have something to do for, and the shadows of lights.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/base/settings.h"
#include "core/chain/estimate/sites.h"
#include "core/chain/geometry/geometry.h"
#include "kernels/estimate/estimate.h"

namespace alcove {

/// Whether the radii depend on a frame's depth (--radius auto, 5%).
bool depends_on_depth(const EstimatorSettings& settings);
/// Puts radii in scene units into the settings.
void take_radii(EstimatorSettings& settings, const std::vector<double>& radii);
/// All radii of the settings, from the smallest on; settings.radius must be set.
std::vector<double> radii_of(const EstimatorSettings& settings);

/// Whether `profile` and `exact` search the slices instead of `horizon`.
bool searches_exactly(const EstimatorSettings& settings);

/// Whether the estimator searches slices through the view ray: gtao and bitmask. These find open directions too,
/// respect thickness, and nothing beyond the radius blocks.
bool searches_slices(const EstimatorSettings& settings);

/// Whether surfaces are completed behind nearer ones. Endless occluders block everything behind them anyway, so with
/// them they are not. Completion beyond the picture's border does not count here.
bool completes(const EstimatorSettings& settings);

/// Whether an estimator by samples reads the pixels' thickness from backs.comp.
bool tells_backs(const EstimatorSettings& settings);

/// Whether surfaces are completed anywhere, if only beyond the picture's border.
bool completes_anywhere(const EstimatorSettings& settings);

/// The depth samples that the settings ask for at so many estimates; 0 for an exact search.
double samples_of(const EstimatorSettings& settings, double estimates);

/// Tiles of a G-buffer that an estimator computes.
struct TileList {
  gpu::Buffer* tiles = nullptr;        // one uint each, see pack_tile
  gpu::Buffer* counts = nullptr;       // one TileCounts
  gpu::Buffer* kinds = nullptr;        // of all tiles, from classify
  gpu::Buffer* lines = nullptr;        // GroupCount of profile, from refine
  gpu::Buffer* sites = nullptr;        // in them, from list_sites; null: all of their pixels
  gpu::Buffer* site_counts = nullptr;  // one SiteCounts; null as the sites
};

/// The workgroups of a pass over the listed tiles, at most one for each.
gpu::Extent list_extent(const TileList& list);

/// The result of an estimator for the sites of a G-buffer.
struct Estimate {
  gpu::Buffer* ao = nullptr;       // a plane of visibility for each radius, from the smallest on
  uint plane = 0;                  // of `ao`: the radius that an estimator writes
  gpu::Buffer* moments = nullptr;  // of the largest radius: see Visibility
  uint order = 0;                  // of the moments
  // The first of two planes of `moments` for each radius, or for the radius that an estimator writes: see Visibility;
  // none: not asked for, or left to estimate_curvature().
  std::optional<uint> curvature{};
  TileList listed{};                  // of the largest radius
  const gpu::Buffer* told = nullptr;  // the pixels' thickness, from backs(); null: by the settings
  gpu::Buffer* error = nullptr;       // with a tolerance, of the mean over the radii: see refine.comp
  gpu::Buffer* squares = nullptr;     // the same
  // A plane of the visibility that completed surfaces block, of the largest radius, before any filter; 0 at sky. Null:
  // not asked for.
  gpu::Buffer* completed = nullptr;
};

/// Runs the estimator of the settings for each of their radii. The frame has the number for animated noise, and the
/// changes.
Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                  const EstimatorSettings& settings, uint order = 0, bool with_completed = false,
                  bool with_curvature = false);

/// Runs an estimator that takes samples for each radius of the settings, into the buffers of `result`.
void estimate_sampled(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                      const EstimatorSettings& settings, Estimate& result);
/// Follows the receivers' own surfaces if the estimator does not, by another search by samples, whose AO is dropped,
/// into the planes of `result` from `first` on.
void estimate_curvature(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                        const EstimatorSettings& settings, const Estimate& result, uint first);
/// The part of an estimate of so many radii that an estimator writes for one; moments and completed visibility belong
/// to the largest alone.
Estimate of_radius(const Estimate& all, uint plane, std::size_t radii);

/// The rules by which surfaces around a receiver block, for one radius.
struct Reach {
  float radius;         // scene units: nothing beyond blocks
  float told;           // scene units: pixels farther away give no thickness
  float front;          // scene units: no front farther away than this blocks by the solid behind it
  float falloff_start;  // scene units: nearer surfaces block fully
  Falloff falloff;
  float thickness;      // scene units of an occluder's depth behind its front; 0: as deep as wide
  float bias;           // the least height that blocks: see EstimatorSettings::bias
  Completion complete;  // see EstimatorSettings::complete
  bool in_sectors;      // bitmask: all blockers are counted in sectors, without an exact horizon
};
Reach reach_of(const EstimatorSettings& settings, double radius);
/// Whether surfaces go on behind nearer ones. Endless occluders block everything behind them anyway.
bool completes_behind(const Reach& reach);

/// The blockers, for the kernels of the search by samples: bits of kThickness*, kCompletes* and kTellsBacks.
uint solid_of(const Reach& reach, bool tells_backs);

/// The samples' spread over the hemisphere, and over neighbouring pixels.
struct Sampling {
  int slices;        // directions per pixel
  int steps;         // samples to each side of a slice
  vec2 noise_shift;  // where the noise pattern begins
};
Sampling sampling_of(const EstimatorSettings& settings, int frame);

/// The tiles that may be left out.
struct Skipping {
  bool skips_sky;
  const gpu::Buffer* changes;           // against the frame before; null: nothing is reused
  ImagePart needed = {};                // the image without the unused part of a margin
  const gpu::Buffer* bounds = nullptr;  // from bounds(): how deep hidden surfaces lie
};
Skipping skipping_of(const EstimatorSettings& settings, const FrameInputs& frame, const BlockGrid& grid);

/// Bounds of the depths of hidden surfaces, for `classify`; null if nothing is hidden, or no tile is left out.
const gpu::Buffer* bounds(gpu::Recorder& gpu, const GBuffer& gbuffer, const Skipping& skipping);

/// Lists the tiles that an estimator must compute within one reach. For the sites of the other tiles it writes the
/// visibility into the plane of `out`, and 0 into out.completed. `prefix` stands before the names of its buffers if
/// there is another estimate.
TileList classify(gpu::Recorder& gpu, const GBuffer& gbuffer, const Skipping& skipping, const Reach& reach,
                  const Sites& sites, const Estimate& out, const std::string& prefix = "");

/// The thickness of the solid at each pixel, a word each, and the chains of pixels of one surface that tell it: see
/// chains.comp, chain_ends.comp and backs.comp.
struct Backs {
  const gpu::Buffer &words, &chains;
};
/// Without normals of their own, surfaces end by depth alone.
Backs backs(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, bool has_normals);

/// gtao and bitmask. Tiles that have hidden surfaces within reach are searched by horizon_layers.
void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
             const Estimate& out);
void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling, Elevation elevation,
          const Estimate& out);
void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
            const EstimatorSettings& settings, const Estimate& out);

// The quick search of sites, with fewer rules than `horizon`.

/// Whether a frame is searched quickly: the settings ask for it, and for nothing that it cannot do. Several radii, a
/// falloff, a given thickness, surfaces that are not completed everywhere, a uniform density, moments,
/// curvature, hidden surfaces, and surfaces that are no occluders are left to the usual search.
bool searches_quickly(const EstimatorSettings& settings, const GBuffer& gbuffer, uint order, bool with_curvature);

/// Depth with a margin about the image, into which surfaces go on: see margin.comp. sites() fills its middle.
const gpu::Buffer& margin(gpu::Recorder& gpu, const GBuffer& gbuffer);
/// The visibility of the sites.
Estimate quick_horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const gpu::Buffer& wide,
                       const FrameInputs& frame, const EstimatorSettings& settings);

/// Sums for each tile of 8 x 8 pixels the visibility that completed surfaces block, and that all block, for the largest
/// radius, at the sites of the widest lattice: see completion.comp. Null without estimate.completed.
gpu::Buffer* completion(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, const Sites& sites);

/// Gives for each light of the frame a plane of the part of it that each pixel sees, 1 = lit; 0 where the surface faces
/// away, 1 for sky. Surfaces block by the rules of the settings for samples, whatever their search. `told`: as
/// Estimate::told, of this G-buffer; null: it is found here. with_confidence: as many planes more, of the confidence in
/// each, see shadow.comp.
gpu::Buffer& shadow(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                    const EstimatorSettings& settings, const gpu::Buffer* told, bool with_confidence);

}  // namespace alcove
