// Host side of the exact search: straight strokes of depth along lines, what they block, and how many directions of
// lines an estimate by its error takes.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/chain/estimate.h"
#include "core/chain/pass_common.h"
#include "kernels/complete.h"
#include "kernels/converge.h"
#include "kernels/exact.h"
#include "kernels/profile.h"

namespace alcove {
namespace {

/// The least directions of an estimate by error, where it has no other estimate to compare with, and the most. Both are
/// powers of 2.
constexpr int kLeastDirections = 2;
constexpr int kMostDirections = 64;

/// How far a profile may leave a pixel's depth, in the pixel's own widths: less costs more vertices.
constexpr float kProfileTolerance = 0.2f;

/// Where surfaces are completed, a run is so thick: its width times the first, and so many pixels more. Thickness need
/// not stand for what is hidden then.
constexpr float kCompletedDepthPerWidth = 0.5f;
constexpr float kCompletedMorePixels = 1;

/// The number of the i-th direction. In this order the first 2, 4, 8 ... directions are even over the half turn.
int bit_reversed(int i) {
  int reversed = 0;
  for (int bit = 1; bit < kMostDirections; bit *= 2) reversed = 2 * reversed + (i / bit & 1);
  return reversed;
}

/// How many pixels lines have moved across at a step: as in lines.glsl.
int shift_at(const Lines& lines, int step) {
  return (lines.slope * (lines.origin.x + step) + kSlopeUnit / 2) >> kSlopeBits;
}

/// The lines of a direction, even in angle where the view's pixels are made square; those of a few directions never
/// follow an axis of the image.
Lines lines_of(const View& view, ivec2 origin, int direction, int directions) {
  const double angle = std::numbers::pi * (direction + 0.5) / directions;
  const double x = std::cos(angle) / view.tangent_per_pixel.x;
  const double y = std::sin(angle) / view.tangent_per_pixel.y;
  const bool steep = std::abs(y) > std::abs(x);
  Lines lines{steep ? 1u : 0u, int(std::lround(kSlopeUnit * (steep ? x / y : y / x))),
              steep ? ivec2{origin.y, origin.x} : origin, 0};
  const int across = steep ? view.size.x : view.size.y;
  const int along = steep ? view.size.y : view.size.x;
  const int most = std::max(std::abs(shift_at(lines, 0)), std::abs(shift_at(lines, along)));
  lines.wrap = (most / across + 1) * across;
  return lines;
}

/// One float per pixel: the sum of the whole arcs over the directions so far.
gpu::Buffer& whole_arcs(gpu::Recorder& gpu, const GBuffer& gbuffer) {
  return gpu.buffer("whole arcs", plane_bytes(gbuffer.view), gpu::Use::device);
}

/// Makes the visibility from the sums of so many directions, and its error, and lists in sums.listed the tiles that
/// need more directions; after 0 directions all that have surfaces.
void compare_directions(gpu::Recorder& gpu, const GBuffer& gbuffer, double tolerance, Estimate& sums, Estimate& result,
                        uint plane, int directions) {
  const ivec2 size = gbuffer.view.size;
  const ivec2 origin = gbuffer.grid.origin;
  const auto tiles_in = [](int pixels, int begin) { return groups_of(pixels + (begin & (kTile - 1)), uint(kTile)); };
  const uint columns = tiles_in(size.x, origin.x);
  const uint tiles = columns * tiles_in(size.y, origin.y);
  const std::string name = "converge " + std::to_string(directions) + " ";
  TileList next;
  next.tiles = &gpu.buffer(name + "tiles", sizeof(ListedTile) * tiles, gpu::Use::device);
  next.counts = &gpu.buffer(name + "counts", sizeof(TileCounts), gpu::Use::device);
  next.lines = &gpu.buffer(name + "lines", sizeof(GroupCount), gpu::Use::device);
  gpu.clear(*next.counts);
  gpu.write(*next.lines, GroupCount{groups_of(2 * (size.x + size.y), kProfileGroup), 1, 0});
  result.error = &gpu.buffer("error", plane_bytes(gbuffer.view), gpu::Use::device);
  result.squares = &gpu.buffer("error squares", sizeof(vec2) * tiles, gpu::Use::device);
  const ConvergeParams params{gbuffer.view,
                              origin,
                              float(tolerance),
                              uint(directions),
                              directions > kLeastDirections ? 1u : 0u,
                              directions == kMostDirections ? 1u : 0u,
                              plane};
  const bool begins = directions == 0;
  gpu.dispatch("converge", params,
               {{kConvergeDepth, *gbuffer.depth},
                {kConvergeBlocked, *sums.ao},
                {kConvergeWhole, whole_arcs(gpu, gbuffer)},
                {kConvergeAo, *result.ao},
                {kConvergeError, *result.error},
                {kConvergeSquares, *result.squares},
                {kConvergeList, begins ? *next.tiles : *sums.listed.tiles},
                {kConvergeCounts, begins ? *next.counts : *sums.listed.counts},
                {kConvergeNextList, *next.tiles},
                {kConvergeNextCounts, *next.counts},
                {kConvergeNextLines, *next.lines},
                {kConvergeNormal, *gbuffer.normal},
                {kConvergeBent, sums.bent ? *sums.bent : *result.ao}},
               {columns, tiles / columns}, {sums.bent ? 1u : 0u});
  sums.listed = next;
}

}  // namespace

SearchDirections search_directions(const EstimatorSettings& settings) {
  const int takers = settings.denoise == Denoise::none ? 1 : 4;
  return {settings.slices * takers, takers, settings.search == SliceSearch::every_pixel};
}

TileList converge(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, double tolerance, bool every_pixel,
                  Estimate& result, uint plane) {
  const SearchDirections directions{kMostDirections, 1, every_pixel};
  Estimate sums;
  sums.bent = result.bent;
  sums.completed = result.completed;
  sums.ao = &gpu.buffer("blocked arcs", plane_bytes(gbuffer.view), gpu::Use::device);
  compare_directions(gpu, gbuffer, tolerance, sums, result, plane, 0);
  const TileList first = sums.listed;
  for (int i = 0; i < kMostDirections; i++) {
    Profile lines = profile(gpu, gbuffer, directions, bit_reversed(i), reach, sums.listed.lines);
    complete(gpu, gbuffer, lines, reach, sums.listed.lines);
    exact(gpu, gbuffer, lines, directions, reach, sums, 0);
    if (i + 1 >= kLeastDirections && std::has_single_bit(uint(i + 1)))
      compare_directions(gpu, gbuffer, tolerance, sums, result, plane, i + 1);
  }
  return first;
}

Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const SearchDirections& directions, int direction,
                const Reach& reach, const gpu::Buffer* groups) {
  const std::size_t bytes = plane_bytes(gbuffer.view);
  const Lines lines = lines_of(gbuffer.view, gbuffer.grid.origin, direction, directions.count);
  Profile result{direction, lines};
  result.vertex = &gpu.buffer("profile vertex", bytes, gpu::Use::device);
  result.mark = &gpu.buffer("profile mark", bytes, gpu::Use::device);
  result.neighbor = &gpu.buffer("profile neighbor", bytes, gpu::Use::device);
  const ivec2 size = gbuffer.view.size;
  const int along = lines.steep ? size.y : size.x;
  const int across = lines.steep ? size.x : size.y;
  if (std::max(size.x, size.y) > int(kNoVertex))
    fail(ErrorKind::usage,
         "an exact search takes at most {} pixels along a line, and there are {}: give --search steps", kNoVertex,
         std::max(size.x, size.y));
  const auto [least, most] = std::minmax({shift_at(lines, 0), shift_at(lines, along - 1)});
  const bool is_thinner = completes_behind(reach);
  result.first = -most;
  result.count = uint(across + most - least);
  const ProfileParams params{gbuffer.view,
                             lines,
                             result.first,
                             result.count,
                             kProfileTolerance,
                             is_thinner ? kCompletedDepthPerWidth : 1,
                             is_thinner ? kCompletedMorePixels : 0,
                             reach.complete != Completion::none ? kCutThickness * reach.radius : 0};
  gpu.dispatch("profile", params,
               {{kProfileDepth, *gbuffer.depth},
                {kProfileVertex, *result.vertex},
                {kProfileMark, *result.mark},
                {kProfileNeighbor, *result.neighbor}},
               groups ? gpu::Extent(*groups) : gpu::Extent(params.count), {directions.every_pixel ? 1u : 0u});
  return result;
}

void complete(gpu::Recorder& gpu, const GBuffer& gbuffer, Profile& profile, const Reach& reach,
              const gpu::Buffer* groups) {
  if (reach.complete == Completion::none) return;
  const std::size_t bytes = plane_bytes(gbuffer.view);
  profile.goes_on = &gpu.buffer("profile goes on", bytes, gpu::Use::device);
  profile.behind = &gpu.buffer("profile behind", bytes, gpu::Use::device);
  const CompleteParams params{gbuffer.view,  profile.lines, profile.first,
                              profile.count, reach.radius,  completes_behind(reach) ? 1u : 0u};
  gpu.dispatch("complete", params,
               {{kCompleteNormal, *gbuffer.normal},
                {kCompleteVertex, *profile.vertex},
                {kCompleteMark, *profile.mark},
                {kCompleteGoesOn, *profile.goes_on},
                {kCompleteBehind, *profile.behind}},
               groups ? gpu::Extent(*groups) : gpu::Extent(profile.count));
}

void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const SearchDirections& directions,
           const Reach& reach, const Estimate& out, uint plane) {
  const Lines& lines = profile.lines;
  const int takers = directions.takers;
  const bool is_listed = out.listed.counts != nullptr;
  ExactParams params{};
  params.view = gbuffer.view;
  params.lines = lines;
  params.stride = takers > 1 ? 2 : 1;
  // Neighbouring directions go to opposite corners of a block; blocks are those of the display window.
  constexpr ivec2 kCorners[] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  const ivec2 corner = kCorners[profile.direction % takers];
  if (takers > 1) params.first = {(corner.x + lines.origin.x) & 1, (corner.y + lines.origin.y) & 1};
  params.direction = uint(profile.direction);
  params.is_first = profile.direction < takers ? 1 : 0;
  params.is_last = !is_listed && profile.direction >= directions.count - takers ? 1 : 0;
  params.radius = reach.radius;
  params.thickness = reach.thickness;
  params.bias = reach.bias;
  params.depth_precision = gbuffer.depth_precision;
  params.plane = plane;
  const ivec2 size = gbuffer.view.size;
  const auto columns = uint((size.x + params.stride - 1) / params.stride);
  const auto rows = uint((size.y + params.stride - 1) / params.stride);
  const gpu::Extent pixels = lines.steep ? gpu::Extent{rows, columns} : gpu::Extent{columns, rows};
  uint completing = profile.goes_on ? 1 : 0;
  if (profile.goes_on && out.completed) completing = 2;
  gpu.dispatch("exact", params,
               {{kExactDepth, *gbuffer.depth},
                {kExactNormal, *gbuffer.normal},
                {kExactVertex, *profile.vertex},
                {kExactMark, *profile.mark},
                {kExactNeighbor, *profile.neighbor},
                {kExactWhole, whole_arcs(gpu, gbuffer)},
                {kExactAo, *out.ao},
                {kExactList, is_listed ? *out.listed.tiles : *out.ao},
                {kExactCounts, is_listed ? *out.listed.counts : *out.ao},
                {kExactGoesOn, profile.goes_on ? *profile.goes_on : *profile.vertex},
                {kExactBehind, profile.behind ? *profile.behind : *profile.mark},
                {kExactCompleted, out.completed ? *out.completed : *out.ao},
                {kExactBent, out.bent ? *out.bent : *out.ao}},
               is_listed ? list_extent(out.listed) : pixels, {is_listed ? 1u : 0u, completing, out.bent ? 1u : 0u});
}

}  // namespace alcove
