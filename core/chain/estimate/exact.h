// The exact search: straight strokes of depth along lines, and the directions that they block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/chain/estimate/estimate.h"
#include "kernels/estimate/exact.h"

namespace alcove {

/// Runs the exact search for each radius of the settings, into the buffers of `result`.
void estimate_exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings, Estimate& result);

/// The directions of an exact search over a frame.
struct SearchDirections {
  int count;         // over all pixels
  int takers;        // pixels that share them: 1, or the 4 of a block if a denoiser mixes their results
  bool every_pixel;  // look at each pixel; else at the outlines of runs of them
};
SearchDirections search_directions(const EstimatorSettings& settings);

/// The depth along all lines of one direction over the image, as straight strokes: see profile.comp and complete.comp.
struct Profile {
  int direction;
  Lines lines;
  int first = 0;            // number of the first line
  uint count = 0;           // lines
  uint slots = 1;           // the most surfaces of a pixel; a plane of vertices, marks, solids and neighbors for each
  bool has_unseen = false;  // behind the slots is a plane for completed surfaces
  gpu::Buffer* vertex = nullptr;
  gpu::Buffer* mark = nullptr;
  gpu::Buffer* solid = nullptr;
  gpu::Buffer* neighbor = nullptr;
  gpu::Buffer* own = nullptr;      // the slot of each step's first surface; null: there is one slot
  gpu::Buffer* goes_on = nullptr;  // null: nothing is completed
  gpu::Buffer* behind = nullptr;   // the same
};
/// `groups`: workgroups, a GroupCount; null: those of all lines.
Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const SearchDirections& directions, int direction,
                const Reach& reach, const gpu::Buffer* groups = nullptr);
/// Completes the surfaces of a profile, if the settings ask for it.
void complete(gpu::Recorder& gpu, const GBuffer& gbuffer, Profile& profile, const Reach& reach,
              const gpu::Buffer* groups = nullptr);
/// Accumulates one direction in the plane of `out` and in out.moments, for the pixels that take it; call it for all
/// directions in order. With listed tiles, these planes keep sums of the blocked parts: converge makes the visibility
/// of them, and refine the moments.
void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const SearchDirections& directions,
           const Reach& reach, const Estimate& out);

/// The numbers of directions at which an estimate with a tolerance is compared: it begins at the first, has nothing to
/// compare with at the second, and ends at the last. In between, tiles with a small error end.
inline constexpr std::array kComparedDirections{0, 2, 4, 8, 16, 32, 64};

/// A search of as many directions as the tolerance takes, for one radius.
struct Convergence {
  double tolerance;    // RMS error of the visibility
  bool every_pixel;    // as in SearchDirections
  uint plane, planes;  // which of the radii it is, and of how many
  Estimate sums;       // over the directions so far; its list has the tiles for the next ones
};
/// `result`: of all radii; its plane is that of the radius.
Convergence convergence(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings,
                        const Estimate& result, uint planes);
/// Searches the directions from the last comparison up to so many.
void search_until(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Convergence& search,
                  int directions);
/// Makes the visibility of so many directions, and the errors of its tiles; after 0 directions all tiles are new.
void converge(gpu::Recorder& gpu, const GBuffer& gbuffer, const Convergence& search, const Estimate& result,
              int directions);
/// Lists the tiles that need more than so many directions, and adds the error of the others, a mean over the radii, to
/// `result`. After 0 directions it lists all tiles with surfaces, in `result` too.
void refine(gpu::Recorder& gpu, const GBuffer& gbuffer, Convergence& search, Estimate& result, int directions);

}  // namespace alcove
