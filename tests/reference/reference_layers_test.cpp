// Hidden surfaces in the CPU reference: analytic peels against rays, and what must change nothing.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference.h"
#include "tests/support/chain.h"
#include "tests/support/scenes.h"

namespace alcove::reference_layers_test {
namespace {

using namespace test;

constexpr int kRaysAcross = 120;

/// Occluders without thickness, but for what is known to be solid, and nothing guessed.
ReferenceSettings known_alone(double radius) {
  ReferenceSettings settings;
  settings.radius = radius;
  settings.slices = 48;
  settings.thickness = ThicknessRule::constant;
  settings.thickness_length = 1e-4;
  return settings;
}

double mean_error(const HostFrame& frame, const ReferenceSettings& settings, const std::vector<double>& truth) {
  const std::vector<float> ao = reference_ao(frame, settings);
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); i++)
    sum += std::abs(ao[settings.pixels[i]] - truth[i]) / double(truth.size());
  return sum;
}

/// With all surfaces known the floor has its true AO to the bound, and with the first ones alone it has not.
void expect_known(const char* what, const Scene& scene, const Shot& shot, double radius, double least_error) {
  const Rendering rendering = render(scene, shot);
  const HostFrame frame = peeled(scene, shot, 4);
  ReferenceSettings settings = known_alone(radius);
  std::vector<double> truth;
  settings.pixels = receivers(rendering, radius, 7, [](const Hit& hit) { return hit.primitive == 0; });
  for (const std::size_t i : settings.pixels) truth.push_back(true_ao(scene, rendering.hits[i], radius, kRaysAcross));
  ASSERT_GE(truth.size(), 15u) << what;
  const double known = mean_error(frame, settings, truth);
  settings.hidden = 0;
  const double first_alone = mean_error(frame, settings, truth);
  EXPECT_LE(known, 0.005) << what << ", the first surfaces alone " << first_alone;
  EXPECT_GE(first_alone, least_error) << what << ", known " << known;
}

TEST(Hidden, what_is_known_behind_others_has_its_true_ao) {
  expect_known("a plate before a wall", {{kFloor, kWallX, parallelogram({0.8, -0.5, 0.3}, {0, 1, 0}, {0, 0, 0.8})}},
               Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, 240, 180), 1, 0.01);
  expect_known(
      "a sphere before a sphere, which is solid",
      {{kFloor, Sphere{.center = {0.7, 0.1, 0.45}, .radius = 0.35}, Sphere{.center = {-0.3, 0, 0.5}, .radius = 0.4}}},
      Shot::perspective({5, 0.3, 2.6}, {0.2, 0, 0.3}, 40, 240, 180), 1, 0.01);
  expect_known("a corridor behind posts",
               {{kFloor, kWallX, Plane{.point = {0, 1.2, 0}, .normal = {0, -1, 0}},
                 parallelogram({0.9, -0.6, 0.1}, {0, 0.5, 0}, {0, 0, 1.2}),
                 parallelogram({1.2, 0.3, 0.1}, {0, 0.4, 0}, {0, 0, 1.2})}},
               Shot::perspective({5, -0.3, 1.8}, {0.3, 0.2, 0.5}, 50, 240, 180), 0.9, 0.01);
}

/// Width as thickness, and all that can be completed.
ReferenceSettings usual(double radius) {
  ReferenceSettings settings;
  settings.radius = radius;
  settings.slices = 4;
  settings.thickness = ThicknessRule::width;
  settings.complete = Completion::border;
  return settings;
}

TEST(Hidden, planes_that_do_not_list_all_leave_what_goes_on_as_it_was) {
  RandomScenes scenes(3);
  ReferenceSettings all = usual(0.5);
  all.complete = Completion::all;
  int compared = 0, changed = 0;
  for (int i = 0; i < 12 && compared < 3; i++) {
    const HostFrame frame = scenes.next();
    if (frame.normal.empty() || frame.depth_kind != DepthKind::planar) continue;
    compared++;
    const std::vector<float> expected = reference_ao(frame, all);
    HostFrame empty = frame;
    empty.behind.assign(1, {.is_whole = false});
    empty.behind_depth.assign(frame.depth.size(), 0);
    EXPECT_EQ(reference_ao(empty, all), expected) << i;
    empty.behind[0].is_whole = true;
    changed += reference_ao(empty, all) != expected ? 1 : 0;
  }
  EXPECT_EQ(compared, 3);
  EXPECT_GT(changed, 0) << "or else nothing goes on in these scenes";
}

TEST(Hidden, a_copy_of_the_first_depth_and_what_lies_beyond_the_sphere_change_no_bit) {
  RandomScenes scenes(3);
  for (int i = 0, compared = 0; compared < 3; i++) {
    ASSERT_LT(i, 30) << "too few scenes have what this takes";
    const HostFrame frame = scenes.next();
    if (frame.normal.empty() || frame.depth_kind != DepthKind::planar) continue;
    compared++;
    const std::vector<float> expected = reference_ao(frame, usual(0.5));
    HostFrame copied = frame;
    copied.behind.assign(1, {});
    copied.behind_depth = frame.depth;
    EXPECT_EQ(reference_ao(copied, usual(0.5)), expected) << i;
    for (float& z : copied.behind_depth)
      if (z < 1e9f) z = 5000;
    EXPECT_EQ(reference_ao(copied, usual(0.5)), expected) << i;
  }
}

}  // namespace
}  // namespace alcove::reference_layers_test
