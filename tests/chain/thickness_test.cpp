// `--thickness auto`, as deep as wide: what is wide has its closed form, what is thin blocks no more than that.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove {
namespace {

using namespace test;

/// Enough slices and steps that only the thickness is left to tell.
EstimatorSettings settings_of(double radius, ThicknessKind thickness, double length = 0) {
  EstimatorSettings settings = plain_settings();
  settings.radius = radius;
  settings.slices = 8;
  settings.steps = 64;
  settings.thickness = thickness;
  settings.thickness_length = length;
  return settings;
}

using Truth = std::function<std::optional<double>(const Hit&)>;

/// The mean error over pixels that have a truth and are not beside an edge.
double mean_error(const Rendering& rendering, const EstimatorSettings& settings, const Truth& truth) {
  const std::vector<float> ao = compute_ao(recorder(), rendering.frame, settings).ao;
  double sum = 0;
  int pixels = 0;
  for (int y = 0; y < rendering.shot.data.height; y++)
    for (int x = 0; x < rendering.shot.data.width; x++) {
      const Hit& hit = rendering.at(x, y);
      const auto expected = hit.primitive < 0 || rendering.primitives_within(2, x, y) > 1 ? std::nullopt : truth(hit);
      if (!expected) continue;
      sum += std::abs(ao[std::size_t(y * rendering.shot.data.width + x)] - *expected);
      pixels++;
    }
  EXPECT_GE(pixels, 1000);
  return sum / std::max(1, pixels);
}

const Plane kFloor{.point = {}, .normal = {0, 0, 1}}, kWall{.point = {}, .normal = {1, 0, 0}};

/// Area of the segment of the unit disk beyond the chord at x.
double segment(double x) { return x >= 1 ? 0 : std::acos(x) - x * std::sqrt(1 - x * x); }

TEST(Thickness, a_wide_wall_blocks_as_an_endless_one) {
  const Shot shot = Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 240, 180);
  EXPECT_LE(mean_error(render({{kFloor, kWall}}, shot), settings_of(1, ThicknessKind::automatic),
                       [&](const Hit& hit) -> std::optional<double> {
                         if (!shot.sees_ball(hit.position, 1)) return std::nullopt;
                         return 1 - segment(hit.primitive == 0 ? hit.position.x : hit.position.z) / std::numbers::pi;
                       }),
            0.005);
}

TEST(Thickness, a_bowl_blocks_all_below_its_rim) {
  const double cosine = 0.5, rim = std::sqrt(0.75);
  const Sphere bowl{.center = {0, 0, 0}, .radius = 1, .axis = {0, 0, -1}, .cos_half_angle = cosine};
  const Plane ground{.point = {0, 0, -cosine}, .normal = {0, 0, 1}, .hole = rim};
  EXPECT_LE(
      mean_error(render({{bowl, ground}}, Shot::perspective({0.1, -0.2, 1}, {0, 0, -0.7}, 90, 240, 240)),
                 settings_of(1000, ThicknessKind::automatic),
                 [&](const Hit& hit) { return hit.primitive == 0 ? std::optional((1 + cosine) / 2) : std::nullopt; }),
      0.005);
}

/// The mean AO of the floor under blades that hang over it.
double floor_under_blades(ThicknessKind thickness, double length = 0) {
  Scene scene{{kFloor}};
  for (int i = -6; i <= 6; i++)
    scene.primitives.emplace_back(parallelogram({0.25 * i, -2, 0.2}, {0.03, 0, 0}, {0, 4, 0}));
  const Rendering rendering = render(scene, Shot::perspective({0.3, -2, 2.4}, {0, 0, 0}, 50, 240, 180));
  const std::vector<float> ao = compute_ao(recorder(), rendering.frame, settings_of(0.6, thickness, length)).ao;
  double sum = 0;
  int pixels = 0;
  for (std::size_t i = 0; i < ao.size(); i++)
    if (rendering.hits[i].primitive == 0 && std::abs(rendering.hits[i].position.x) < 1) sum += ao[i], pixels++;
  return sum / pixels;
}

TEST(Thickness, thin_blades_block_as_thin_ones) {
  const double measured = floor_under_blades(ThicknessKind::automatic),
               thin = floor_under_blades(ThicknessKind::constant, 0.03),
               endless = floor_under_blades(ThicknessKind::infinite);
  EXPECT_NEAR(measured, thin, 0.05);
  EXPECT_GE(measured, endless + 0.1);
}

}  // namespace
}  // namespace alcove
