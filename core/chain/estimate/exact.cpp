// Host side of the exact search: straight strokes of depth along lines, what they block, and how many directions of
// lines an estimate by its error takes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/exact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/chain/base/planes.h"

namespace alcove {
namespace {

/// The most directions of an estimate by error, a power of 2.
constexpr int kMostDirections = kComparedDirections.back();
// All but the first two and the last decide.
static_assert(kComparedDirections.size() == kRefineRounds + 3);

/// A profile may leave a pixel's depth by so many of the pixel's own widths: less costs more vertices.
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

/// The pixels that lines have moved across at a step: as in lines.glsl.
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
  return gpu.buffer("whole arcs", plane_bytes(gbuffer.view));
}

/// The tiles of a frame, as an estimate by its error counts them.
struct Tiles {
  uint columns, rows;
  std::uint64_t count() const { return std::uint64_t(columns) * rows; }
};

Tiles tiles_of(const GBuffer& gbuffer) {
  const auto tiles_in = [](int pixels, int begin) { return groups_of(pixels + (begin & (kTile - 1)), uint(kTile)); };
  const ivec2 size = gbuffer.view.size, origin = gbuffer.grid.origin;
  return {tiles_in(size.x, origin.x), tiles_in(size.y, origin.y)};
}

/// One JudgedTile per tile.
gpu::Buffer& judged_tiles(gpu::Recorder& gpu, const GBuffer& gbuffer) {
  return gpu.buffer("judged tiles", sizeof(JudgedTile) * tiles_of(gbuffer).count());
}

/// The empty list of the tiles that take more than so many directions.
TileList next_list(gpu::Recorder& gpu, const GBuffer& gbuffer, int directions) {
  const ivec2 size = gbuffer.view.size;
  const std::string name = "refine " + std::to_string(directions) + " ";
  TileList next;
  next.tiles = &gpu.buffer(name + "tiles", sizeof(uint) * tiles_of(gbuffer).count());
  next.counts = &gpu.buffer(name + "counts", sizeof(TileCounts));
  next.lines = &gpu.buffer(name + "lines", sizeof(GroupCount));
  gpu.clear(*next.counts);
  gpu.write(*next.lines, GroupCount{groups_of(2 * (size.x + size.y), kProfileGroup), 1, 0});
  return next;
}

/// The planes of a profile.
uint planes_of(const Profile& profile) { return profile.slots + (profile.has_unseen ? 1 : 0); }

/// Draws the profiles of all slots, from `slot` 0 on, or behind them that of which surfaces go on
/// behind what is nearer.
void draw_profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const SearchDirections& directions, const Reach& reach,
                  const Profile& profile, uint slot, const gpu::Buffer* groups) {
  const bool is_thinner = completes_behind(reach) || (gbuffer.hidden && reach.complete != Completion::none);
  ProfileParams params{gbuffer.view,
                       profile.lines,
                       profile.first,
                       profile.count,
                       kProfileTolerance,
                       is_thinner ? kCompletedDepthPerWidth : 1,
                       is_thinner ? kCompletedMorePixels : 0,
                       kWidestRun * reach.radius,
                       reach.complete != Completion::none ? kCutThickness * reach.radius : 0,
                       reach.radius,
                       reach.thickness == 0 ? 1u : 0u,
                       slot};
  // With several slots a thickness of 0 is one that is not known, for which exact takes the given one.
  if (gbuffer.hidden && reach.thickness != 0) params.depth_per_width = params.more_pixels = params.least_at_border = 0;
  gpu.dispatch("profile", params,
               {{"Depth", occluder_depth_of(gbuffer)},
                {"Vertex", profile.vertex},
                {"Mark", profile.mark},
                {"Solid", profile.solid},
                {"Neighbor", profile.neighbor},
                {"Normal", gbuffer.normal},
                {"Hidden", gpu::Optional(occluder_hidden_of(gbuffer))},
                {"Own", gpu::Optional(profile.own)}},
               groups ? gpu::Extent(*groups) : gpu::Extent(profile.count),
               {directions.every_pixel ? 1u : 0u, profile.slots, slot > 0 ? 1 : profile.slots});
}

}  // namespace

void estimate_exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings, Estimate& result) {
  const auto radii = radii_of(settings);
  const SearchDirections directions = search_directions(settings);
  if (result.completed) gpu.clear(*result.completed);
  for (uint plane = 0; plane < radii.size(); plane++) {
    const Reach reach = reach_of(settings, radii[plane]);
    const Estimate out = of_radius(result, plane, radii.size());
    for (int i = 0; settings.tolerance == 0 && i < directions.count; i++) {
      Profile lines = profile(gpu, gbuffer, directions, i, reach);
      complete(gpu, gbuffer, lines, reach);
      exact(gpu, gbuffer, lines, directions, reach, out);
    }
    if (settings.tolerance == 0) continue;
    Convergence search = convergence(gpu, gbuffer, settings, out, uint(radii.size()));
    for (const int count : kComparedDirections) {
      search_until(gpu, gbuffer, reach, search, count);
      converge(gpu, gbuffer, search, result, count);
      refine(gpu, gbuffer, search, result, count);
    }
  }
}

SearchDirections search_directions(const EstimatorSettings& settings) {
  const int takers = settings.denoise == Denoise::none ? 1 : 4;
  return {settings.slices * takers, takers, settings.every_pixel};
}

Convergence convergence(gpu::Recorder& gpu, const GBuffer& gbuffer, const EstimatorSettings& settings,
                        const Estimate& result, uint planes) {
  Convergence search{settings.tolerance, settings.every_pixel, result.plane, planes, {}};
  search.sums.ao = &gpu.buffer("blocked arcs", plane_bytes(gbuffer.view));
  search.sums.moments = result.moments;
  search.sums.order = result.order;
  search.sums.completed = result.completed;
  return search;
}

void search_until(gpu::Recorder& gpu, const GBuffer& gbuffer, const Reach& reach, const Convergence& search,
                  int directions) {
  const SearchDirections all{kMostDirections, 1, search.every_pixel};
  const int before = *(std::ranges::find(kComparedDirections, directions) - (directions > 0 ? 1 : 0));
  const Estimate& sums = search.sums;
  for (int i = before; i < directions; i++) {
    Profile lines = profile(gpu, gbuffer, all, bit_reversed(i), reach, sums.listed.lines);
    complete(gpu, gbuffer, lines, reach, sums.listed.lines);
    exact(gpu, gbuffer, lines, all, reach, sums);
  }
}

void converge(gpu::Recorder& gpu, const GBuffer& gbuffer, const Convergence& search, const Estimate& result,
              int directions) {
  gpu::Buffer& judged = judged_tiles(gpu, gbuffer);
  const ConvergeParams params{gbuffer.view, gbuffer.grid.origin, uint(directions), search.plane};
  const Tiles tiles = tiles_of(gbuffer);
  const TileList& listed = search.sums.listed;
  gpu.dispatch("converge", params,
               {{"Depth", gbuffer.depth},
                {"Blocked", search.sums.ao},
                {"Whole", whole_arcs(gpu, gbuffer)},
                {"Ao", result.ao},
                {"Judged", judged},
                {"List", gpu::Optional(listed.tiles)},
                {"Counts", gpu::Optional(listed.counts)}},
               {tiles.columns, tiles.rows});
}

void refine(gpu::Recorder& gpu, const GBuffer& gbuffer, Convergence& search, Estimate& result, int directions) {
  const Tiles tiles = tiles_of(gbuffer);
  const TileList listed = search.sums.listed, next = next_list(gpu, gbuffer, directions);
  result.error = &gpu.buffer("error", plane_bytes(gbuffer.view));
  result.squares = &gpu.buffer("error squares", sizeof(vec2) * tiles.count());
  RefineParams params{};
  params.view = gbuffer.view;
  params.origin = gbuffer.grid.origin;
  params.tolerance = float(search.tolerance);
  params.directions = uint(directions);
  params.decides = directions > kComparedDirections[1] ? 1 : 0;
  params.ends = directions == kMostDirections ? 1 : 0;
  params.is_first = search.plane == 0 ? 1 : 0;
  params.share = 1.0f / float(search.planes);
  gpu.dispatch("refine", params,
               {{"Depth", gbuffer.depth},
                {"Judged", judged_tiles(gpu, gbuffer)},
                {"List", gpu::Optional(listed.tiles)},
                {"Counts", gpu::Optional(listed.counts)},
                {"Error", result.error},
                {"Squares", result.squares},
                {"NextList", next.tiles},
                {"NextCounts", next.counts},
                {"NextLines", next.lines},
                {"Whole", whole_arcs(gpu, gbuffer)},
                {"Moments", gpu::Optional(search.sums.moments)}},
               {tiles.columns, tiles.rows}, {search.sums.order});
  search.sums.listed = next;
  if (directions == 0) result.listed = next;
}

Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const SearchDirections& directions, int direction,
                const Reach& reach, const gpu::Buffer* groups) {
  const Lines lines = lines_of(gbuffer.view, gbuffer.grid.origin, direction, directions.count);
  Profile result{direction, lines};
  result.slots = gbuffer.surfaces;
  result.has_unseen = gbuffer.hidden && completes_behind(reach);
  const std::size_t bytes = planes_of(result) * plane_bytes(gbuffer.view);
  result.vertex = &gpu.buffer("profile vertex", bytes);
  result.mark = &gpu.buffer("profile mark", bytes);
  result.solid = &gpu.buffer("profile solid", bytes);
  result.neighbor = &gpu.buffer("profile neighbor", bytes);
  if (gbuffer.hidden) result.own = &gpu.buffer("profile own", plane_bytes(gbuffer.view));
  const ivec2 size = gbuffer.view.size;
  const int along = lines.steep ? size.y : size.x;
  const int across = lines.steep ? size.x : size.y;
  if (std::max(size.x, size.y) > int(kNoVertex))
    fail(ErrorKind::usage,
         "an exact search takes at most {} pixels along a line, and there are {}: give --search steps", kNoVertex,
         std::max(size.x, size.y));
  const auto [least, most] = std::minmax({shift_at(lines, 0), shift_at(lines, along - 1)});
  result.first = -most;
  result.count = uint(across + most - least);
  draw_profile(gpu, gbuffer, directions, reach, result, 0, groups);
  if (result.has_unseen) draw_profile(gpu, gbuffer, directions, reach, result, result.slots, groups);
  return result;
}

void complete(gpu::Recorder& gpu, const GBuffer& gbuffer, Profile& profile, const Reach& reach,
              const gpu::Buffer* groups) {
  if (!completes_behind(reach)) return;
  const std::size_t bytes = plane_bytes(gbuffer.view);
  profile.goes_on = &gpu.buffer("profile goes on", planes_of(profile) * bytes);
  profile.behind = &gpu.buffer("profile behind", bytes);
  const uint slot = planes_of(profile) - 1;
  gpu.dispatch(
      "complete", CompleteParams{gbuffer.view, profile.lines, profile.first, profile.count, reach.radius, slot},
      {{"Normal", gbuffer.normal},
       {"Vertex", profile.vertex},
       {"Mark", profile.mark},
       {"GoesOn", profile.goes_on},
       {"Behind", profile.behind},
       {"Depth", occluder_depth_of(gbuffer)},
       {"Hidden", gpu::Optional(occluder_hidden_of(gbuffer))}},
      groups ? gpu::Extent(*groups) : gpu::Extent(profile.count), {profile.slots, gbuffer.hides_no_more ? 1u : 0u});
}

void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const SearchDirections& directions,
           const Reach& reach, const Estimate& out) {
  const Lines& lines = profile.lines;
  const int takers = directions.takers;
  const bool is_listed = out.listed.counts != nullptr;
  ExactParams params{};
  params.view = gbuffer.view;
  params.lines = lines;
  params.stride = takers > 1 ? 2 : 1;
  // Neighbouring directions go to opposite corners of a block, (x, y); blocks are those of the display window.
  constexpr ivec2 kCorners[] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  const ivec2 of_block = kCorners[profile.direction % takers];
  const ivec2 corner = lines.steep ? ivec2{of_block.y, of_block.x} : of_block;
  if (takers > 1) params.first = {(corner.x + lines.origin.x) & 1, (corner.y + lines.origin.y) & 1};
  params.direction = uint(profile.direction);
  params.is_first = profile.direction < takers ? 1 : 0;
  params.is_last = !is_listed && profile.direction >= directions.count - takers ? 1 : 0;
  params.radius = reach.radius;
  params.thickness = reach.thickness;
  params.bias = reach.bias;
  params.depth_precision = gbuffer.depth_precision;
  params.plane = out.plane;
  const ivec2 size = gbuffer.view.size;
  const auto columns = uint((size.x + params.stride - 1) / params.stride);
  const auto rows = uint((size.y + params.stride - 1) / params.stride);
  const gpu::Extent pixels = lines.steep ? gpu::Extent{rows, columns} : gpu::Extent{columns, rows};
  const uint completing = (reach.complete != Completion::none ? kExactBorder : 0) |
                          (profile.goes_on ? kExactBehind : 0) | (out.completed ? kExactApart : 0);
  gpu.dispatch("exact", params,
               {{"Depth", gbuffer.depth},
                {"Normal", gbuffer.normal},
                {"Vertex", profile.vertex},
                {"Mark", profile.mark},
                {"Solid", profile.solid},
                {"Neighbor", profile.neighbor},
                {"Whole", whole_arcs(gpu, gbuffer)},
                {"Ao", out.ao},
                {"List", gpu::Optional(out.listed.tiles)},
                {"Counts", gpu::Optional(out.listed.counts)},
                {"GoesOn", gpu::Optional(profile.goes_on)},
                {"Behind", gpu::Optional(profile.behind)},
                {"Completed", gpu::Optional(out.completed)},
                {"Moments", gpu::Optional(out.moments)},
                {"Own", gpu::Optional(profile.own)},
                {"Occluders", occluder_depth_of(gbuffer)}},
               is_listed ? list_extent(out.listed) : pixels,
               {is_listed ? 1u : 0u, completing, out.order, profile.slots, profile.has_unseen ? 1u : 0u});
}

}  // namespace alcove
