// The estimators, and the passes that list the tiles they have something to do for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "core/base/settings.h"
#include "core/chain/estimate/sites.h"
#include "core/chain/geometry/geometry.h"
#include "kernels/estimate/exact_search.h"

namespace alcove {

/// Tiles of a G-buffer that an estimator has something to do for.
struct TileList {
  gpu::Buffer* tiles = nullptr;        // one uint each, see pack_tile
  gpu::Buffer* counts = nullptr;       // one TileCounts
  gpu::Buffer* kinds = nullptr;        // of all tiles, from classify
  gpu::Buffer* lines = nullptr;        // GroupCount of profile, from refine
  gpu::Buffer* sites = nullptr;        // that lie in them, from list_sites; null: all of their pixels
  gpu::Buffer* site_counts = nullptr;  // one SiteCounts; null as the sites
  bool skips_surfaces = false;         // more than sky may be left out
};

/// The workgroups of a pass over the listed tiles, of which each takes at most one.
gpu::Extent list_extent(const TileList& list);
/// The workgroups of an estimator over what is listed.
gpu::Extent estimate_extent(const TileList& list);

/// What an estimator gives for the sites of a G-buffer.
struct Estimate {
  gpu::Buffer* ao = nullptr;       // a plane of visibility for each radius, from the smallest on
  gpu::Buffer* bent = nullptr;     // planes x, y, z, of the largest radius: see horizon.comp; null: not asked for
  TileList listed{};               // of the largest radius
  gpu::Buffer* error = nullptr;    // with a tolerance, of the mean over the radii: see refine.comp
  gpu::Buffer* squares = nullptr;  // the same
  // A plane of the visibility that completed surfaces took, of the largest radius, before any filter: 0 to what is
  // blocked, 0 at sky. Null: not asked for.
  gpu::Buffer* completed = nullptr;
};

/// Runs the estimator of the settings for each of their radii. The frame gives the number that animates the noise, and
/// what has changed.
Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites, const FrameInputs& frame,
                  const EstimatorSettings& settings, bool with_bent = false, bool with_completed = false);

/// What blocks around a receiver, for one radius.
struct Reach {
  float radius;         // scene units: nothing beyond blocks
  float falloff_start;  // scene units: what is nearer blocks fully
  Falloff falloff;
  float thickness;      // scene units that an occluder goes on behind what is seen of it; 0: as deep as wide
  float bias;           // the least height that blocks: see EstimatorSettings::bias
  Completion complete;  // where surfaces go on unseen: see EstimatorSettings::complete
  bool in_sectors;      // of bitmask: all that blocks is counted in sectors, no horizon is exact
};
Reach reach_of(const EstimatorSettings& settings, double radius);
/// Whether surfaces go on behind what is nearer. What endless occluders hide is blocked anyway.
bool completes_behind(const Reach& reach);

/// How samples are spread over the hemisphere, and over neighbouring pixels.
struct Sampling {
  int slices;        // directions per pixel
  int steps;         // samples to each side of a slice
  vec2 noise_shift;  // where the noise pattern begins
};
Sampling sampling_of(const EstimatorSettings& settings, int frame);

/// Crytek's samples in the volume of the hemisphere.
struct VolumeSamples {
  int count;
  SampleKernel kernel;
  RangeCheck range_check;
};

/// How far estimates count beyond their own pixels, in px of the frame: the denoiser by pixels of the estimate, and
/// upsampling by two of them. So does the choice of how many directions a tile takes.
int filter_reach_of(const EstimatorSettings& settings);
/// How far depths count for where estimates are made, in px of the frame: see sites.comp.
int site_reach_of(const EstimatorSettings& settings);

/// What may be left out.
struct Skipping {
  bool skips_sky;
  const gpu::Buffer* changes;  // against the frame before; null: it gives nothing
  ImagePart needed = {};       // the image without what of a margin nobody needs
};
Skipping skipping_of(const EstimatorSettings& settings, const FrameInputs& frame, const BlockGrid& grid);

/// Bounds what is hidden, by which `classify` tells the tiles where it may count; null where nothing is hidden, or
/// nothing is left out.
const gpu::Buffer* bounds(gpu::Recorder& gpu, const GBuffer& gbuffer, const Skipping& skipping);

/// Lists the tiles that an estimator must compute for one radius. Into a plane of `out` it writes the visibility of the
/// sites of those that are left out, and into out.completed 0 for them. `prefix` stands before the names of its buffers
/// where there is another estimate.
TileList classify(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer* bounds, const Skipping& skipping,
                  float radius, const Sites& sites, const Estimate& out, uint plane, const std::string& prefix = "");

/// gtao and bitmask. Tiles that have hidden surfaces within reach are searched by horizon_layers.
void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
             const Estimate& out, uint plane);
void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling, Elevation elevation,
          const Estimate& out, uint plane);
void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Sampling& sampling,
            const VolumeSamples& samples, const Estimate& out, uint plane);

/// The directions of an exact search over a frame.
struct SearchDirections {
  int count;         // over all pixels
  int takers;        // pixels that share them: 1, or the 4 of a block where a denoiser mixes what they found
  bool every_pixel;  // look at each pixel; else at the outlines of runs of them
};
SearchDirections search_directions(const EstimatorSettings& settings);

/// The depth along all lines of one direction over the image, as straight strokes: see profile.comp and complete.comp.
struct Profile {
  int direction;
  Lines lines;
  int first = 0;            // number of the first line
  uint count = 0;           // lines
  uint slots = 1;           // a plane of vertices, marks and neighbors each; as many as a pixel has surfaces at most
  bool has_unseen = false;  // behind the slots is a plane for what goes on behind what is nearer
  gpu::Buffer* vertex = nullptr;
  gpu::Buffer* mark = nullptr;
  gpu::Buffer* neighbor = nullptr;
  gpu::Buffer* own = nullptr;      // the slot of each step's first surface; null: there is one slot
  gpu::Buffer* goes_on = nullptr;  // null: no surface goes on unseen
  gpu::Buffer* behind = nullptr;   // the same
};
/// `groups`: workgroups, a GroupCount; null: those of all lines.
Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const SearchDirections& directions, int direction,
                const Reach& reach, const gpu::Buffer* groups = nullptr);
/// Finds how far the surfaces of a profile go on unseen, where the settings say that any do.
void complete(gpu::Recorder& gpu, const GBuffer& gbuffer, Profile& profile, const Reach& reach,
              const gpu::Buffer* groups = nullptr);
/// Adds a direction to a plane of out.ao and to out.bent, for the pixels that take it; call it for all directions in
/// order. Where tiles are listed, these planes keep the sums of what is blocked, from which converge makes the
/// visibility, and refine the mean open direction.
void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const SearchDirections& directions,
           const Reach& reach, const Estimate& out, uint plane);

/// The directions after which an estimate by its error is compared: at the first it begins, at the second it has
/// nothing to compare with, and at the last it ends. In between tiles that are good are left.
inline constexpr std::array kComparedDirections{0, 2, 4, 8, 16, 32, 64};

/// A search of as many directions as the tolerance takes, for one radius.
struct Convergence {
  double tolerance;    // RMS error of the visibility
  bool every_pixel;    // as in SearchDirections
  uint plane, planes;  // which of the radii it is, and of how many
  Estimate sums;       // over the directions so far; its list has the tiles that take the next ones
};
Convergence convergence(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings,
                        const Estimate& result, uint plane, uint planes);
/// Searches the directions from the last comparison up to so many.
void search_until(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Convergence& search,
                  int directions);
/// Makes the visibility of so many directions, and judges its tiles; after 0 directions all tiles are new.
void converge(gpu::Recorder& gpu, const GBuffer& gbuffer, const Convergence& search, const Estimate& result,
              int directions);
/// Lists the tiles that take more than so many directions, and adds to `result` the error of the others, which is the
/// mean over the radii. After 0 directions it lists all that have surfaces, in `result` too.
void refine(gpu::Recorder& gpu, const GBuffer& gbuffer, Convergence& search, Estimate& result, int directions);

}  // namespace alcove
