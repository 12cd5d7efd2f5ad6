// How far back solids go in a search by samples, by all that is seen of them: against rays.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/hidden_truth.h"

namespace alcove::backs_test {
namespace {

using namespace test;

/// Of the chosen pixels, for a radius of 1, by rays and by samples.
struct Means {
  double truth = 0, ao = 0, error = 0;
};

Means means_of(const Scene& scene, const Shot& shot, const Chosen& chosen, int every) {
  const Rendering rendering = render(scene, shot);
  EstimatorSettings settings = sampled(Estimator::gtao, 1, 8, 16);
  settings.thickness = ThicknessKind::automatic;
  settings.complete = Completion::all;
  const std::vector<float> ao = ao_of(rendering.frame, settings);
  Means means;
  int count = 0;
  for (int y = 1; y < shot.data.height - 1; y += every)
    for (int x = 1; x < shot.data.width - 1; x += every) {
      const Hit& hit = rendering.at(x, y);
      if (hit.primitive < 0 || rendering.primitives_within(1, x, y) > 1 || !chosen(hit)) continue;
      const double truth = true_ao(scene, hit, 1, 40);
      const double here = ao[std::size_t(y) * std::size_t(shot.data.width) + std::size_t(x)];
      means.truth += truth;
      means.ao += here;
      means.error += std::abs(here - truth);
      count++;
    }
  EXPECT_GE(count, 30);
  return {means.truth / count, means.ao / count, means.error / count};
}

bool is_below_box(const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0 && std::abs(hit.position.y) < 1; }

// A box so deep and high above the floor, whose front is at x = 0.
Scene box_above_floor(double depth, double above, double height) {
  Scene scene{{kFloor}};
  scene.add(parallelepiped({-depth, -1.5, above}, {depth, 0, 0}, {0, 3, 0}, {0, 0, height}));
  return scene;
}

TEST(Backs, of_a_box_above_the_floor_are_no_farther_than_its_top_goes) {
  const Vec3 target{0, 0, 0.3};
  for (const Vec3 eye : {Vec3{6, 0, 2.2}, Vec3{5, 0, 4}})
    for (const Shot& shot :
         {Shot::perspective(eye, target, 42, 320, 224), Shot::orthographic(eye, target, 5, 320, 224)})
      // One that is higher than deep is taken for as deep as it is high.
      for (const auto& [depth, height] : {std::pair(0.3, 0.2), {1.0, 0.2}, {1.0, 0.5}}) {
        const Means below = means_of(box_above_floor(depth, 0.35, height), shot, is_below_box, 4);
        EXPECT_NEAR(below.ao, below.truth, 0.05) << depth << " deep, " << height << " high, from " << eye.z;
      }
}

// Its top is a few rows of pixels.
TEST(Backs, of_a_box_are_as_far_as_its_top_goes_that_samples_miss) {
  for (const double eye : {0.9, 1.2}) {
    const Means below = means_of(box_above_floor(2, 0.35, 0.2),
                                 Shot::perspective({6, 0, eye}, {0, 0, 0.3}, 36, 400, 200), is_below_box, 4);
    EXPECT_NEAR(below.ao, below.truth, 0.07) << "seen from " << eye;
  }
}

TEST(Backs, of_a_railing_are_no_farther_than_it_is_wide) {
  for (const double bar : {0.03, 0.06}) {
    // A floor that juts out of a wall, seen from below, with bars along its edge.
    Scene scene{{kWallX}};
    scene.add(parallelepiped({0, -3, -0.1}, {0.7, 0, 0}, {0, 6, 0}, {0, 0, 0.1}));
    for (int i = -12; i <= 12; i++)
      scene.add(parallelepiped({0.7 - bar, 0.2 * i, 0}, {bar, 0, 0}, {0, bar, 0}, {0, 0, 1.4}));
    const auto is_behind = [](const Hit& hit) {
      return hit.primitive == 0 && std::abs(hit.position.y) < 1 && std::abs(hit.position.z - 0.7) < 0.3;
    };
    const Means wall = means_of(scene, Shot::perspective({6, -1.5, -2}, {0, 0, 0.4}, 26, 480, 336), is_behind, 5);
    EXPECT_NEAR(wall.ao, wall.truth, 0.05) << bar;
  }
}

TEST(Backs, of_a_ball_mirror_its_front) {
  const Scene scene{{kFloor, Sphere{.center = {0, 0, 0.8}, .radius = 0.5}}};
  for (const double eye : {3.0, 1.0}) {
    const Means beside = means_of(
        scene, Shot::perspective({5, 0, eye}, {0, 0, 0.3}, 40, 320, 224),
        [](const Hit& hit) { return hit.primitive == 0 && std::hypot(hit.position.x, hit.position.y) < 1; }, 4);
    EXPECT_LE(beside.error, 0.05) << eye;
  }
}

}  // namespace
}  // namespace alcove::backs_test
