// Host side of the estimators, and of what they leave out.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/chain/pass_common.h"
#include "kernels/bitmask.h"
#include "kernels/bounds.h"
#include "kernels/classify.h"
#include "kernels/coarsen.h"
#include "kernels/confidence.h"
#include "kernels/converge.h"
#include "kernels/crytek.h"
#include "kernels/exact.h"
#include "kernels/hbao.h"
#include "kernels/horizon.h"
#include "kernels/profile.h"

namespace alcove {
namespace {

/// As kernels take it: 0 says as deep as wide.
float thickness_of(const EstimatorSettings& settings) {
  if (settings.thickness == ThicknessKind::automatic) return 0;
  return settings.thickness == ThicknessKind::infinite ? std::numeric_limits<float>::infinity()
                                                       : float(settings.thickness_length);
}

uint range_check_of(RangeCheck check) {
  return check == RangeCheck::ratio ? kRangeRatio : check == RangeCheck::smoothstep ? kRangeSmoothstep : kRangeNone;
}

/// Where the noise pattern begins: successive frames, where it is animated, take successive points of the R2 sequence,
/// seeds of another.
vec2 noise_shift(int frame, std::uint32_t seed) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  const auto shift = [&](double by_frame, double by_seed) {
    return float(fraction(0.5 + fraction(frame * by_frame) + fraction(seed * by_seed)));
  };
  return {shift(0.75487766624669276, 0.41421356237309505), shift(0.56984029099805327, 0.73205080756887729)};
}

/// How far from a receiver anything blocks. Crytek's samples fill the sphere of the radius whatever the falloff.
double reach_of(const EstimatorSettings& settings) {
  return settings.radius.value() * (settings.estimator == Estimator::crytek ? 1 : settings.falloff_end);
}

/// Of the estimators that search slices.
template <class Params>
Params slice_parameters(const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
                        uint plane) {
  Params params{};
  params.view = gbuffer.view;
  params.radius = float(reach_of(settings));
  params.falloff_start = float(settings.radius.value() * settings.falloff_start);
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(settings.noise == Noise::animated ? frame.frame : 0, settings.seed);
  params.thickness = thickness_of(settings);
  params.bias = float(settings.bias);
  params.plane = plane;
  params.depth_precision = to_vec3(frame.depth_precision.at);
  return params;
}
std::vector<uint> slice_constants(const EstimatorSettings& settings, const gpu::Buffer* bent = nullptr) {
  return {uint(settings.slices), uint(settings.steps), uint(settings.falloff) | (bent ? kWithBent : 0),
          uint(stride_of(settings))};
}

/// Tiles in x and y.
gpu::Extent tile_extent(const View& view) {
  return {groups_of(view.size.x, uint(kTile)), groups_of(view.size.y, uint(kTile))};
}

/// Groups of tiles in x and y.
gpu::Extent group_extent(const View& view) {
  return {groups_of(view.size.x, uint(kTile * kTileGroup)), groups_of(view.size.y, uint(kTile * kTileGroup))};
}

/// Of one radius, on average over the pixels of a surface.
double samples_of_a_radius(const EstimatorSettings& settings) {
  const double factor = double(settings.resolution), samples = settings.estimator == Estimator::crytek
                                                                   ? settings.samples
                                                                   : 2 * settings.slices * settings.steps;
  return samples / (factor * factor * stride_of(settings));
}

/// Samples a pixel from which on a proof that tiles are open costs less than it saves: it costs as much as 6 of them,
/// and most frames are open in a tenth.
constexpr double kWorthProving = 48;

/// Directions of an estimate by error: at the least, where it has no other estimate to compare with, and at the most;
/// powers of 2.
constexpr int kLeastDirections = 2, kMostDirections = 64;

/// In this order 2, 4, 8 ... of the most directions are even.
int bit_reversed(int i) {
  int reversed = 0;
  for (int bit = 1; bit < kMostDirections; bit *= 2) reversed = 2 * reversed + (i / bit & 1);
  return reversed;
}

/// Thickness of thin occluders, in radii.
constexpr double kThin = 0.02;

/// How far a profile may leave a pixel's depth, in the pixel's own widths: less costs more vertices.
constexpr float kProfileTolerance = 0.2f;

/// Directions of an exact search over a frame: each pixel takes all of them, or a quarter where a denoiser mixes those
/// of its block of 2 x 2.
int directions_of(const EstimatorSettings& settings) {
  return settings.slices * (settings.denoise == Denoise::none ? 1 : 4);
}

/// Pixels that lines have moved across at a step: as in lines.glsl.
int shift_at(const Lines& lines, int step) {
  return (lines.slope * (lines.origin.x + step) + kSlopeUnit / 2) >> kSlopeBits;
}

/// The lines of a direction, even in angle where the view's pixels are made square; those of a few directions never
/// follow an axis of the image.
Lines lines_of(const View& view, ivec2 origin, int direction, int directions) {
  const double angle = std::numbers::pi * (direction + 0.5) / directions;
  const double x = std::cos(angle) / view.tangent_per_pixel.x, y = std::sin(angle) / view.tangent_per_pixel.y;
  const bool steep = std::abs(y) > std::abs(x);
  Lines lines{steep ? 1u : 0u, int(std::lround(kSlopeUnit * (steep ? x / y : y / x))),
              steep ? ivec2{origin.y, origin.x} : origin, 0};
  const int across = steep ? view.size.x : view.size.y;
  const int most = std::max(std::abs(shift_at(lines, 0)), std::abs(shift_at(lines, steep ? view.size.y : view.size.x)));
  lines.wrap = (most / across + 1) * across;
  return lines;
}

/// The visibility that the sums of so many directions give, its error, and for sums.listed the tiles that need more; of
/// 0 directions: all with surfaces.
void compare_directions(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings, Estimate& sums, Estimate& all, uint plane, int directions) {
  const ivec2 size = gbuffer.view.size, origin = frame.noise_origin;
  const auto tiles_in = [](int pixels, int begin) { return groups_of(pixels + (begin & (kTile - 1)), uint(kTile)); };
  const uint columns = tiles_in(size.x, origin.x), tiles = columns * tiles_in(size.y, origin.y);
  const std::string name = "converge " + std::to_string(directions) + " ";
  const TileList next{&gpu.buffer(name + "tiles", sizeof(ListedTile) * tiles, gpu::Use::device),
                      &gpu.buffer(name + "counts", sizeof(TileCounts), gpu::Use::download), nullptr,
                      &gpu.buffer(name + "lines", sizeof(GroupCount), gpu::Use::upload)};
  gpu.clear(*next.counts);
  next.lines->as<GroupCount>()[0] = {groups_of(2 * (size.x + size.y), kProfileGroup), 1, 0};
  gpu.upload(*next.lines);
  all.error = &gpu.buffer("error", plane_bytes(gbuffer.view), gpu::Use::download);
  all.squares = &gpu.buffer("error squares", sizeof(vec2) * tiles, gpu::Use::download);
  const ConvergeParams params{
      gbuffer.view, origin, float(settings.tolerance), uint(directions), directions > kLeastDirections ? 1u : 0u,
      plane};
  const bool begins = directions == 0;
  gpu.dispatch("converge", params,
               {{kConvergeDepth, *gbuffer.depth},
                {kConvergeBlocked, *sums.ao},
                {kConvergeWhole, gpu.buffer("whole arcs", plane_bytes(gbuffer.view), gpu::Use::device)},
                {kConvergeAo, *all.ao},
                {kConvergeError, *all.error},
                {kConvergeSquares, *all.squares},
                {kConvergeList, begins ? *next.tiles : *sums.listed.tiles},
                {kConvergeCounts, begins ? *next.counts : *sums.listed.counts},
                {kConvergeNextList, *next.tiles},
                {kConvergeNextCounts, *next.counts},
                {kConvergeNextLines, *next.lines}},
               {columns, tiles / columns});
  sums.listed = next;
}

}  // namespace

bool searches_exactly(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::gtao && (settings.search != SliceSearch::steps || settings.tolerance > 0);
}

int stride_of(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return 1;
  if (settings.stride > 0) return settings.stride;
  const bool shared =
      settings.denoise == Denoise::bilateral && settings.resolution == Resolution::full && settings.slices <= 2;
  return shared && settings.estimator == Estimator::gtao ? 4 : 1;
}

std::vector<double> radii_of(const EstimatorSettings& settings) {
  std::vector<double> radii = settings.further_radii;
  radii.push_back(settings.radius.value());
  std::ranges::sort(radii);
  return radii;
}

bool has_bent_normals(const EstimatorSettings& settings) {
  return settings.estimator == Estimator::bitmask ||
         (settings.estimator == Estimator::gtao && !searches_exactly(settings));
}

Estimate estimate(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& inputs,
                  const EstimatorSettings& settings, bool with_bent, const std::string& prefix) {
  const BlockGrid grid = block_grid(inputs, settings);
  FrameInputs frame = inputs;
  frame.noise_origin = grid.origin;
  const auto radii = radii_of(settings);
  Estimate all{&gpu.buffer(prefix + "ao", radii.size() * plane_bytes(gbuffer.view), gpu::Use::download)};
  if (with_bent) all.bent = &gpu.buffer("bent", 3 * plane_bytes(gbuffer.view), gpu::Use::download);
  const Bounds surfaces = bounds(gpu, gbuffer, frame, settings);
  if (surfaces.tiles) coarsen(gpu, gbuffer, surfaces);
  for (uint plane = 0; plane < radii.size(); plane++) {
    EstimatorSettings one = settings;
    one.radius = radii[plane];
    Estimate out{all.ao, plane + 1 == radii.size() ? all.bent : nullptr};
    if (!searches_exactly(one))
      all.listed = out.listed = classify(gpu, gbuffer, frame, grid, one, surfaces, out, plane, prefix);
    switch (settings.estimator) {
      case Estimator::gtao:
        if (!searches_exactly(one)) horizon(gpu, gbuffer, frame, one, out, plane);
        for (int direction = 0; searches_exactly(one) && one.tolerance == 0 && direction < directions_of(one);
             direction++) {
          const Profile lines = profile(gpu, gbuffer, frame, one, direction);
          exact(gpu, gbuffer, lines, frame, one, out, plane);
        }
        if (one.tolerance > 0) all.listed = converge(gpu, gbuffer, frame, one, all, plane);
        break;
      case Estimator::bitmask: bitmask(gpu, gbuffer, frame, one, out, plane); break;
      case Estimator::hbao: hbao(gpu, gbuffer, frame, one, out, plane); break;
      case Estimator::crytek: crytek(gpu, gbuffer, frame, one, out, plane); break;
    }
  }
  return all;
}

double samples_per_pixel(const EstimatorSettings& settings) {
  return searches_exactly(settings) ? 0 : samples_of_a_radius(settings) * double(1 + settings.further_radii.size());
}

bool proves(const EstimatorSettings& settings) {
  return !settings.no_skip && !searches_exactly(settings) &&
         (settings.skip_tolerance > 0 || samples_of_a_radius(settings) >= kWorthProving);
}

Bounds bounds(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings) {
  if (!proves(settings)) return {};
  const gpu::Extent tiles = tile_extent(gbuffer.view), groups = group_extent(gbuffer.view);
  const Bounds result{&gpu.buffer("bounds", sizeof(TileBounds) * tiles.x * tiles.y, gpu::Use::device),
                      &gpu.buffer("group bounds", sizeof(GroupBounds) * groups.x * groups.y, gpu::Use::device)};
  gpu.dispatch("bounds", BoundsParams{gbuffer.view, frame.noise_origin},
               {{kBoundsDepth, *gbuffer.depth}, {kBoundsNormal, *gbuffer.normal}, {kBoundsTiles, *result.tiles}}, tiles,
               {uint(stride_of(settings))});
  return result;
}

void coarsen(gpu::Recorder& gpu, const GBuffer& gbuffer, const Bounds& bounds) {
  gpu.dispatch("coarsen", CoarsenParams{gbuffer.view.size},
               {{kCoarsenTiles, *bounds.tiles}, {kCoarsenGroups, *bounds.groups}}, group_extent(gbuffer.view));
}

TileList classify(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const BlockGrid& grid,
                  const EstimatorSettings& settings, const Bounds& bounds, const Estimate& out, uint plane,
                  const std::string& prefix) {
  const gpu::Extent tiles = tile_extent(gbuffer.view);
  const TileList list{&gpu.buffer("tiles", sizeof(ListedTile) * tiles.x * tiles.y, gpu::Use::device),
                      &gpu.buffer(prefix + "tile counts", sizeof(TileCounts), gpu::Use::download),
                      &gpu.buffer(prefix + "tile sectors", sizeof(uint) * tiles.x * tiles.y, gpu::Use::device)};
  gpu.clear(*list.counts);
  const bool ranged = settings.estimator == Estimator::gtao || settings.estimator == Estimator::bitmask;
  const uint mode = (settings.no_skip ? 0 : kClassifySkips) | (proves(settings) ? kClassifyProves : 0) |
                    (ranged ? kClassifyRanged : 0) | (out.bent ? kClassifyWithBent : 0) |
                    (frame.changes && !settings.no_skip ? kClassifyReuses : 0) |
                    (settings.skip_tolerance > 0 ? kClassifyTolerates : 0);
  const ClassifyParams params{gbuffer.view,
                              frame.noise_origin,
                              float(reach_of(settings)),
                              float(std::sqrt(settings.skip_tolerance)),
                              to_vec3(frame.depth_precision.at),
                              plane,
                              frame.view.size,
                              grid.overhang,
                              grid.factor};
  gpu.dispatch("classify", params,
               {{kClassifyBounds, bounds.tiles ? *bounds.tiles : *list.tiles},
                {kClassifyGroups, bounds.groups ? *bounds.groups : *list.tiles},
                {kClassifyChanges, frame.changes ? *frame.changes : *list.tiles},
                {kClassifyDepth, *gbuffer.depth},
                {kClassifyNormal, *gbuffer.normal},
                {kClassifyList, *list.tiles},
                {kClassifyCounts, *list.counts},
                {kClassifySectors, *list.sectors},
                {kClassifyAo, *out.ao},
                {kClassifyBent, out.bent ? *out.bent : *out.ao}},
               {groups_of(int(tiles.x), 2 * kGroupY) * kGroupX, groups_of(int(tiles.y), 2) * kGroupY},
               {uint(stride_of(settings)), mode});
  return list;
}

void horizon(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
             const Estimate& out, uint plane) {
  std::vector<uint> constants = slice_constants(settings, out.bent);
  constants.push_back(settings.thickness == ThicknessKind::automatic  ? kThicknessWidth
                      : settings.thickness == ThicknessKind::constant ? kThicknessLength
                                                                      : kThicknessEndless);
  gpu.dispatch("horizon", slice_parameters<HorizonParams>(gbuffer, frame, settings, plane),
               {{kHorizonDepth, *gbuffer.depth},
                {kHorizonNormal, *gbuffer.normal},
                {kHorizonAo, *out.ao},
                {kHorizonBent, out.bent ? *out.bent : *out.ao},
                {kHorizonList, *out.listed.tiles},
                {kHorizonCounts, *out.listed.counts}},
               gpu::Extent(*out.listed.counts), constants);
}

TileList converge(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                  const EstimatorSettings& settings, Estimate& all, uint plane) {
  EstimatorSettings every = settings;
  every.slices = kMostDirections;
  every.denoise = Denoise::none;
  if (every.search == SliceSearch::steps) every.search = SliceSearch::exact;
  Estimate sums{&gpu.buffer("blocked arcs", plane_bytes(gbuffer.view), gpu::Use::device)};
  compare_directions(gpu, gbuffer, frame, settings, sums, all, plane, 0);
  const TileList first = sums.listed;
  for (int i = 0; i < kMostDirections; i++) {
    exact(gpu, gbuffer, profile(gpu, gbuffer, frame, every, bit_reversed(i), sums.listed.lines), frame, every, sums, 0);
    if (i + 1 >= kLeastDirections && std::has_single_bit(uint(i + 1)))
      compare_directions(gpu, gbuffer, frame, settings, sums, all, plane, i + 1);
  }
  return first;
}

Profile profile(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
                int direction, const gpu::Buffer* groups) {
  const std::size_t bytes = plane_bytes(gbuffer.view);
  const Lines lines = lines_of(gbuffer.view, frame.noise_origin, direction, directions_of(settings));
  const Profile result{direction, lines, &gpu.buffer("profile vertex", bytes, gpu::Use::device),
                       &gpu.buffer("profile mark", bytes, gpu::Use::device),
                       &gpu.buffer("profile neighbor", bytes, gpu::Use::device)};
  const ivec2 size = gbuffer.view.size;
  if (std::max(size.x, size.y) > int(kNoVertex))
    fail(ErrorKind::usage,
         "an exact search takes at most {} pixels along a line, and there are {}: give --search steps", kNoVertex,
         std::max(size.x, size.y));
  const auto [least, most] = std::minmax({shift_at(lines, 0), shift_at(lines, (lines.steep ? size.y : size.x) - 1)});
  const ProfileParams params{gbuffer.view, lines, -most, uint((lines.steep ? size.x : size.y) + most - least),
                             kProfileTolerance};
  gpu.dispatch("profile", params,
               {{kProfileDepth, *gbuffer.depth},
                {kProfileVertex, *result.vertex},
                {kProfileMark, *result.mark},
                {kProfileNeighbor, *result.neighbor}},
               groups ? gpu::Extent(*groups) : gpu::Extent(params.count),
               {settings.search == SliceSearch::every_pixel ? 1u : 0u});
  return result;
}

void exact(gpu::Recorder& gpu, const GBuffer& gbuffer, const Profile& profile, const FrameInputs& frame,
           const EstimatorSettings& settings, const Estimate& out, uint plane) {
  const Lines& lines = profile.lines;
  const int directions = directions_of(settings), takers = directions / settings.slices;
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
  params.is_last = !out.listed.counts && profile.direction >= directions - takers ? 1 : 0;
  params.radius = float(reach_of(settings));
  params.thickness = thickness_of(settings);
  params.bias = float(settings.bias);
  params.depth_precision = to_vec3(frame.depth_precision.at);
  params.plane = plane;
  const ivec2 size = gbuffer.view.size,
              taken{(size.x + params.stride - 1) / params.stride, (size.y + params.stride - 1) / params.stride};
  gpu.dispatch("exact", params,
               {{kExactDepth, *gbuffer.depth},
                {kExactNormal, *gbuffer.normal},
                {kExactVertex, *profile.vertex},
                {kExactMark, *profile.mark},
                {kExactNeighbor, *profile.neighbor},
                {kExactWhole, gpu.buffer("whole arcs", plane_bytes(gbuffer.view), gpu::Use::device)},
                {kExactAo, *out.ao},
                {kExactList, out.listed.tiles ? *out.listed.tiles : *out.ao},
                {kExactCounts, out.listed.counts ? *out.listed.counts : *out.ao}},
               out.listed.counts ? gpu::Extent(*out.listed.counts)
               : lines.steep     ? gpu::Extent{uint(taken.y), uint(taken.x)}
                                 : gpu::Extent{uint(taken.x), uint(taken.y)},
               {out.listed.counts ? 1u : 0u});
}

void bitmask(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
             const Estimate& out, uint plane) {
  gpu.dispatch("bitmask", slice_parameters<BitmaskParams>(gbuffer, frame, settings, plane),
               {{kBitmaskDepth, *gbuffer.depth},
                {kBitmaskNormal, *gbuffer.normal},
                {kBitmaskAo, *out.ao},
                {kBitmaskBent, out.bent ? *out.bent : *out.ao},
                {kBitmaskList, *out.listed.tiles},
                {kBitmaskCounts, *out.listed.counts}},
               gpu::Extent(*out.listed.counts), slice_constants(settings, out.bent));
}

void hbao(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
          const Estimate& out, uint plane) {
  HbaoParams params{};
  params.view = gbuffer.view;
  params.radius = float(reach_of(settings));
  params.falloff_start = float(settings.radius.value() * settings.falloff_start);
  params.bias = float(settings.bias);
  params.from_surface = settings.elevation == Elevation::surface ? 1 : 0;
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(settings.noise == Noise::animated ? frame.frame : 0, settings.seed);
  params.plane = plane;
  params.depth_precision = to_vec3(frame.depth_precision.at);
  gpu.dispatch("hbao", params,
               {{kHbaoDepth, *gbuffer.depth},
                {kHbaoNormal, *gbuffer.normal},
                {kHbaoAo, *out.ao},
                {kHbaoList, *out.listed.tiles},
                {kHbaoCounts, *out.listed.counts}},
               gpu::Extent(*out.listed.counts), slice_constants(settings));
}

void crytek(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame, const EstimatorSettings& settings,
            const Estimate& out, uint plane) {
  CrytekParams params{};
  params.view = gbuffer.view;
  params.radius = float(reach_of(settings));
  params.bias = float(settings.bias);
  params.uniform_volume = settings.sample_kernel == SampleKernel::uniform ? 1 : 0;
  params.range_check = range_check_of(settings.range_check);
  params.noise_origin = frame.noise_origin;
  params.noise_shift = noise_shift(settings.noise == Noise::animated ? frame.frame : 0, settings.seed);
  params.plane = plane;
  params.depth_precision = to_vec3(frame.depth_precision.at);
  gpu.dispatch("crytek", params,
               {{kCrytekDepth, *gbuffer.depth},
                {kCrytekNormal, *gbuffer.normal},
                {kCrytekAo, *out.ao},
                {kCrytekList, *out.listed.tiles},
                {kCrytekCounts, *out.listed.counts}},
               gpu::Extent(*out.listed.counts), {uint(settings.samples), uint(stride_of(settings))});
}

gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings) {
  EstimatorSettings bracket = settings;
  bracket.estimator = Estimator::gtao;
  bracket.search = SliceSearch::steps;
  bracket.tolerance = 0;
  bracket.resolution = Resolution::full;
  bracket.further_radii.clear();
  bracket.radius = radii_of(settings).back();
  const auto visibility = [&](ThicknessKind thickness, const std::string& prefix) -> const gpu::Buffer& {
    bracket.thickness = thickness;
    bracket.thickness_length = kThin * *bracket.radius;
    const gpu::Buffer& ao = *estimate(gpu, gbuffer, frame, bracket, false, prefix).ao;
    return bracket.denoise == Denoise::none ? ao : denoise(gpu, gbuffer, ao, frame, bracket, prefix);
  };
  const gpu::Buffer &thin = visibility(ThicknessKind::constant, "thin "),
                    &solid = visibility(ThicknessKind::infinite, "solid ");
  gpu::Buffer& result = gpu.buffer("confidence", plane_bytes(gbuffer.view), gpu::Use::download);
  const ConfidenceParams params{gbuffer.view, float(*bracket.radius), to_vec3(frame.depth_precision.at)};
  gpu.dispatch("confidence", params,
               {{kConfidenceDepth, *gbuffer.depth},
                {kConfidenceNormal, *gbuffer.normal},
                {kConfidenceThin, thin},
                {kConfidenceSolid, solid},
                {kConfidenceResult, result}},
               extent_of(gbuffer.view));
  return result;
}

}  // namespace alcove
