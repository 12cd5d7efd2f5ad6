// The pyramid of planes that proofs rely on: no surface is before any of them, whatever the size and the values.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/chain/compute.h"
#include "core/chain/geometry.h"
#include "kernels/bounds.h"
#include "kernels/coarsen.h"
#include "tests/support/device.h"
#include "tests/support/random_scenes.h"

namespace alcove {
namespace {

using namespace test;

struct Pyramid {
  View view{};
  std::vector<float> depth;
  std::vector<TileBounds> tiles;
  std::vector<GroupBounds> groups;
  ivec2 tile_count{}, group_count{};
};

template <class T>
std::vector<T> contents(const gpu::Buffer& buffer) {
  const auto values = buffer.as<const T>();
  return {values.begin(), values.end()};
}

Pyramid pyramid_of(const HostFrame& frame) {
  gpu::Recorder& gpu = recorder();
  const FrameInputs inputs = upload(gpu, frame);
  upload(gpu, inputs);
  const GBuffer gbuffer = prepare(gpu, inputs);
  reconstruct(gpu, gbuffer);
  Pyramid p;
  p.view = gbuffer.view;
  const auto parts = [](int pixels, int side) { return (pixels + side - 1) / side; };
  p.tile_count = {parts(p.view.size.x, kTile), parts(p.view.size.y, kTile)};
  p.group_count = {parts(p.tile_count.x, kTileGroup), parts(p.tile_count.y, kTileGroup)};
  gpu::Buffer& tiles =
      gpu.buffer("shown bounds", sizeof(TileBounds) * std::size_t(p.tile_count.x * p.tile_count.y), gpu::Use::device);
  gpu::Buffer& groups = gpu.buffer("shown groups", sizeof(GroupBounds) * std::size_t(p.group_count.x * p.group_count.y),
                                   gpu::Use::device);
  gpu.dispatch("bounds", BoundsParams{p.view, 0},
               {{kBoundsDepth, *gbuffer.depth},
                {kBoundsNormal, *gbuffer.normal},
                {kBoundsHidden, *gbuffer.depth},
                {kBoundsTiles, tiles}},
               {uint(p.tile_count.x), uint(p.tile_count.y)});
  gpu.dispatch("coarsen", CoarsenParams{p.view.size}, {{kCoarsenTiles, tiles}, {kCoarsenGroups, groups}},
               {uint(p.group_count.x), uint(p.group_count.y)});
  for (const auto* buffer : {gbuffer.depth, &tiles, &groups}) gpu.download(*buffer);
  gpu.run();
  p.depth = contents<float>(*gbuffer.depth);
  p.tiles = contents<TileBounds>(tiles);
  p.groups = contents<GroupBounds>(groups);
  return p;
}

/// The nearness that a plane gives a pixel of a square, and room for how floats round.
struct Limit {
  double at, room;
};
Limit plane_at(vec2 gradient, float at_centre, int x, int y, int side) {
  const double dx = x % side - 0.5 * (side - 1), dy = y % side - 0.5 * (side - 1);
  const double size = std::abs(double(at_centre)) + std::abs(gradient.x * dx) + std::abs(gradient.y * dy);
  return {at_centre + gradient.x * dx + gradient.y * dy, 1e-6 * size};
}

void expect_conservative(const Pyramid& p, const std::string& what) {
  constexpr int kGroup = kTile * kTileGroup;
  std::size_t before = 0;
  for (int y = 0; y < p.view.size.y; y++)
    for (int x = 0; x < p.view.size.x; x++) {
      const double z = p.depth[std::size_t(y * p.view.size.x + x)];
      ASSERT_TRUE(z > 0 && std::isfinite(z)) << what;
      if (z >= double(kSkyDepth)) continue;
      const double nearness = p.view.orthographic ? -z : 1 / z;
      const ivec2 at{x / kTile, y / kTile};
      const TileBounds& tile = p.tiles[std::size_t(at.y * p.tile_count.x + at.x)];
      const GroupBounds& group = p.groups[std::size_t(y / kGroup * p.group_count.x + x / kGroup)];
      const auto check = [&](const Limit& limit) { before += nearness > limit.at + limit.room; };
      check(plane_at(tile.gradient, tile.plane[0], x, y, kTile));
      check(plane_at({0, 0}, tile.plane[kTilePlanes - 1], x, y, kTile));
      for (int k = 0; k < 8; k++) {
        const ivec2 step = k < 3 ? ivec2{k - 1, -1} : k < 6 ? ivec2{k - 4, 1} : ivec2{k * 2 - 13, 0};
        const ivec2 beside{std::clamp(at.x + step.x, 0, p.tile_count.x - 1),
                           std::clamp(at.y + step.y, 0, p.tile_count.y - 1)};
        check(plane_at(p.tiles[std::size_t(beside.y * p.tile_count.x + beside.x)].gradient, tile.plane[k + 1], x, y,
                       kTile));
      }
      check(plane_at(group.gradient, group.plane, x, y, kGroup));
      check(plane_at({0, 0}, group.level, x, y, kGroup));
      before += nearness < tile.farthest - 1e-6 * std::abs(double(tile.farthest)) || tile.farthest < tile.last ||
                tile.last < group.last;
    }
  EXPECT_EQ(before, 0u) << what;
  for (std::size_t i = 0; i < p.tiles.size(); i++) {
    const int x0 = int(i) % p.tile_count.x * kTile, y0 = int(i) / p.tile_count.x * kTile;
    bool is_sky = true;
    for (int y = y0; y < std::min(y0 + kTile, p.view.size.y); y++)
      for (int x = x0; x < std::min(x0 + kTile, p.view.size.x); x++)
        is_sky &= p.depth[std::size_t(y * p.view.size.x + x)] >= kSkyDepth;
    ASSERT_EQ(p.tiles[i].farthest > p.tiles[i].plane[kTilePlanes - 1], is_sky) << what << " tile " << i;
  }
}

TEST(Bounds, no_surface_is_before_them) {
  RandomScenes random(41);
  for (int i = 0; i < 300 && !HasFailure(); i++)
    expect_conservative(pyramid_of(random.next()), "scene " + std::to_string(i));
}

TEST(Bounds, of_any_values_at_any_size) {
  RandomScenes random(43);
  for (const auto& [width, height] : {std::pair{1, 1},
                                      {3, 5},
                                      {7, 9},
                                      {8, 8},
                                      {31, 33},
                                      {33, 31},
                                      {63, 65},
                                      {97, 101},
                                      {129, 17},
                                      {1, 131},
                                      {131, 1}})
    for (int kind = 0; kind < 6 && !HasFailure(); kind++) {
      HostFrame frame =
          render({{Plane{{0, 0, 0}, {0, 0, 1}}}}, Shot::perspective({0, -3, 1}, {0, 0, 0}, 60, width, height)).frame;
      if (kind == 5)
        frame =
            render({{Plane{{0, 0, 0}, {0, 0, 1}}}}, Shot::orthographic({0, -3, 1}, {0, 0, 0}, 4, width, height)).frame;
      for (float& z : frame.depth) {
        const float unusual[] = {std::numeric_limits<float>::quiet_NaN(),
                                 std::numeric_limits<float>::infinity(),
                                 -std::numeric_limits<float>::infinity(),
                                 0,
                                 -1,
                                 2e9f,
                                 std::numeric_limits<float>::denorm_min(),
                                 1e-6f,
                                 9e8f};
        const int chance = random.whole(0, 1 << kind);
        if (chance == 0) z = unusual[random.whole(0, 8)];
        if (chance == 1) z = std::ldexp(float(random.whole(1, 1000)), random.whole(-12, 12));
      }
      expect_conservative(pyramid_of(frame),
                          std::to_string(width) + "x" + std::to_string(height) + " kind " + std::to_string(kind));
    }
}

}  // namespace
}  // namespace alcove
