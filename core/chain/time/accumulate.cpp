// Host side of suspects.comp, moved.comp and accumulate.comp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/time/accumulate.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/chain/base/planes.h"
#include "core/chain/estimate/estimate.h"
#include "kernels/time/accumulate.h"

namespace alcove {
namespace {

/// The tiles of the largest of all frames of a group, and of the frame.
gpu::Extent most_tiles(const EstimateSet& estimates, const SeenGroup& group) {
  gpu::Extent most = tile_extent(estimates.view);
  for (const auto& frame : group.frames->as<const NeighbourFrame>().first(group.count)) {
    const gpu::Extent of_frame = tile_extent(frame.view);
    most = {std::max(most.x, of_frame.x), std::max(most.y, of_frame.y)};
  }
  return most;
}

/// The squares of 2 x 2 pixels in the largest of these frames.
ivec2 most_squares(const EstimateSet& estimates, const SeenGroup& group) {
  const gpu::Extent tiles = most_tiles(estimates, group);
  return {int(tiles.x) * kSquares, int(tiles.y) * kSquares};
}

}  // namespace

const gpu::Buffer& suspects(gpu::Recorder& gpu, const EstimateSet& estimates, const SeenGroup& group) {
  const ivec2 squares = most_squares(estimates, group);
  const gpu::Extent extent{uint(squares.x), uint(squares.y)};
  const gpu::Buffer& bits = gpu.buffer("suspects", std::size_t(extent.x) * extent.y * sizeof(uint));
  gpu.dispatch("suspects", SuspectsParams{estimates.view, squares},
               {{"Own", estimates.depth},
                {"Normal", estimates.normal},
                {"Others", group.planes},
                {"Frames", group.frames},
                {"Bits", bits}},
               extent, {group.listed});
  return bits;
}

void moved(gpu::Recorder& gpu, const EstimateSet& estimates, const SeenGroup& group, const gpu::Buffer& suspects,
           float radius, uint place, const gpu::Buffer& near) {
  const gpu::Extent tiles = most_tiles(estimates, group);
  const uint rows = groups_of(int(tiles.y), kGroupY);
  gpu.dispatch("moved", MovedParams{estimates.view, radius, place, most_squares(estimates, group), int(rows)},
               {{"Own", estimates.depth},
                {"Others", group.planes},
                {"Frames", group.frames},
                {"Suspects", suspects},
                {"Near", near}},
               {tiles.x, rows * kGroupY * group.count}, {estimates.has_moving});
}

Accumulation accumulate(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimateSet& estimates,
                        const EstimatorSettings& settings, std::size_t scales, uint order, bool with_curvature) {
  const float radius = reach_of(settings, radii_of(settings).back()).radius;
  const gpu::Buffer& near = gpu.buffer("moved near", kMovedCells * sizeof(uint));
  if (!estimates.is_further_part) {
    gpu.clear(near);
    uint place = 0;
    for (const SeenGroup& group : estimates.groups) {
      const gpu::Buffer& found = suspects(gpu, estimates, group);
      moved(gpu, estimates, group, found, radius, place, near);
      place += group.count;
    }
  }
  const std::size_t curved = with_curvature ? 2 * radii_of(settings).size() : 0, further = moments_in(order) + curved;
  const std::size_t plane = plane_bytes(gbuffer.view), values = 1 + scales + further;
  gpu::Buffer& sums = gpu.buffer("accumulated sums", (1 + values) * plane);
  Visibility mean{&gpu.buffer("accumulated", plane)};
  if (scales > 0) mean.scales = &gpu.buffer(fmt::format("{}accumulated", kScalesPrefix), scales * plane);
  if (further > 0) mean.moments = &gpu.buffer(fmt::format("{}accumulated", kMomentsPrefix), further * plane);

  AccumulateParams params{estimates.view, gbuffer.view.size, estimates.corner, radius, 0, int(scales), 0, 0};
  const std::vector<SeenGroup> none(1);
  const auto& groups = estimates.groups.empty() ? none : estimates.groups;
  for (std::size_t i = 0; i < groups.size(); i++) {
    const SeenGroup& group = groups[i];
    params.frames = group.count;
    params.stage = (i == 0 ? kAccumulateBegins : 0) | (i + 1 == groups.size() ? kAccumulateEnds : 0);
    gpu.dispatch("accumulate", params,
                 {{"Depth", gbuffer.depth},
                  {"Normal", gbuffer.normal},
                  {"Values", estimates.values},
                  {"Others", gpu::Optional(group.planes)},
                  {"Frames", gpu::Optional(group.frames)},
                  {"Near", near},
                  {"Sums", sums},
                  {"Ao", mean.ao},
                  {"Scales", gpu::Optional(mean.scales)},
                  {"Moments", gpu::Optional(mean.moments)}},
                 extent_of(gbuffer.view), {uint(values), group.listed, order, uint(curved)});
    params.place += group.count;
  }
  return {mean, &sums};
}

}  // namespace alcove
