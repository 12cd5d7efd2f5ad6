// Host side of moved.comp and accumulate.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/accumulate.h"

#include <algorithm>

#include "core/base/estimator_facts.h"
#include "core/chain/pass_common.h"
#include "kernels/accumulate.h"

namespace alcove {
namespace {

gpu::Extent tiles_of(const View& view) {
  return {groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
}

/// The tiles of the largest of all frames.
gpu::Extent most_tiles(const EstimateSet& estimates) {
  gpu::Extent most = tiles_of(estimates.view);
  for (const auto& group : estimates.groups)
    for (const auto& frame : group.frames->as<const TakenFrame>().first(group.count)) {
      const gpu::Extent of_frame = tiles_of(frame.view);
      most = {std::max(most.x, of_frame.x), std::max(most.y, of_frame.y)};
    }
  return most;
}

/// As the kernel takes what there is none of.
const gpu::Buffer& or_else(const gpu::Buffer* buffer, const gpu::Buffer& other) { return buffer ? *buffer : other; }

}  // namespace

const gpu::Buffer& moved(gpu::Recorder& gpu, const EstimateSet& estimates, float radius) {
  const gpu::Buffer& near = gpu.buffer("moved near", kMovedCells * sizeof(uint), gpu::Use::device);
  if (estimates.is_further_part) return near;
  gpu.clear(near);
  const gpu::Extent tiles = most_tiles(estimates), squares{tiles.x * uint(kSquares), tiles.y * uint(kSquares)};
  const gpu::Buffer& suspects =
      gpu.buffer("suspects", std::size_t(squares.x) * squares.y * sizeof(uint), gpu::Use::device);
  const uint rows = groups_of(int(tiles.y), kGroupY);
  MovedParams params{estimates.view, radius, 0, {int(squares.x), int(squares.y)}, int(rows)};
  for (const auto& group : estimates.groups) {
    gpu.dispatch("suspects", SuspectsParams{estimates.view, params.squares},
                 {{kSuspectsOwn, *estimates.depth},
                  {kSuspectsNormal, *estimates.normal},
                  {kSuspectsOthers, *group.planes},
                  {kSuspectsFrames, *group.frames},
                  {kSuspectsBits, suspects}},
                 squares, {group.count});
    gpu.dispatch("moved", params,
                 {{kMovedOwn, *estimates.depth},
                  {kMovedOthers, *group.planes},
                  {kMovedFrames, *group.frames},
                  {kMovedSuspects, suspects},
                  {kMovedNear, near}},
                 {tiles.x, rows * kGroupY * group.count}, {estimates.has_moving});
    params.place += group.count;
  }
  return near;
}

Accumulation accumulate(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimateSet& estimates,
                        const EstimatorSettings& settings, std::size_t scales, bool with_bent) {
  const float radius = reach_of(settings, radii_of(settings).back()).radius;
  const auto buffer = [&](const std::string& name, std::size_t bytes) -> gpu::Buffer& {
    return gpu.buffer(name, bytes, gpu::Use::device);
  };
  const gpu::Buffer& near = moved(gpu, estimates, radius);
  const std::size_t plane = plane_bytes(gbuffer.view), values = 1 + scales + (with_bent ? 3 : 0);
  gpu::Buffer& sums = buffer("accumulated sums", (1 + values) * plane);
  Visibility mean{&buffer("accumulated", plane)};
  if (scales > 0) mean.scales = &buffer(std::string(kScalesPrefix) + "accumulated", scales * plane);
  if (with_bent) mean.bent = &buffer(std::string(kBentPrefix) + "accumulated", 3 * plane);

  AccumulateParams params{estimates.view, gbuffer.view.size, estimates.corner, radius, 0, int(scales)};
  const std::vector<SeenGroup> none(1);
  const auto& groups = estimates.groups.empty() ? none : estimates.groups;
  for (std::size_t i = 0; i < groups.size(); i++) {
    const SeenGroup& group = groups[i];
    const uint stage = (i == 0 ? kAccumulateBegins : 0) | (i + 1 == groups.size() ? kAccumulateEnds : 0);
    gpu.dispatch("accumulate", params,
                 {{kAccumulateDepth, *gbuffer.depth},
                  {kAccumulateNormal, *gbuffer.normal},
                  {kAccumulateValues, *estimates.values},
                  {kAccumulateOthers, or_else(group.planes, *estimates.depth)},
                  {kAccumulateFrames, or_else(group.frames, *estimates.depth)},
                  {kAccumulateNear, near},
                  {kAccumulateSums, sums},
                  {kAccumulateAo, *mean.ao},
                  {kAccumulateScales, or_else(mean.scales, *mean.ao)},
                  {kAccumulateBent, or_else(mean.bent, *mean.ao)}},
                 extent_of(gbuffer.view), {stage, uint(values), group.count});
    params.place += group.count;
  }
  return {mean, &sums};
}

}  // namespace alcove
