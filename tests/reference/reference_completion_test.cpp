// Completed surfaces of the CPU reference, where what one depth layer hides is known: against casting rays.
// SPDX-License-Identifier: BSD-3-Clause
//
// The scenes are of flat things without thickness, so the reference is told that occluders are thin. Without completed
// surfaces it then misses exactly what is hidden, and each test shows that this is a lot.

#include "tests/support/chain.h"
#include "tests/support/reference_planes.h"
#include "tests/support/scenes.h"

namespace alcove::reference_completion_test {
namespace {

using namespace test;

constexpr double kThin = 1e-4;  // scene units
constexpr int kRaysAcross = 160;
constexpr int kEvery = 5;  // px from one receiver to the next

ReferenceSettings thin(double radius, Completion complete) {
  ReferenceSettings settings;
  settings.radius = radius;
  settings.slices = 64;
  settings.thickness = ThicknessRule::constant;
  settings.thickness_length = kThin;
  settings.complete = complete;
  return settings;
}

struct Errors {
  double mean = 0, worst = 0;
};

Errors errors_of(const std::vector<float>& ao, const std::vector<std::size_t>& pixels,
                 const std::vector<double>& truth) {
  Errors errors;
  for (std::size_t i = 0; i < pixels.size(); i++) {
    const double error = std::abs(ao[pixels[i]] - truth[i]);
    errors.mean += error / double(pixels.size());
    errors.worst = std::max(errors.worst, error);
  }
  return errors;
}

// Completed, the chosen surfaces have their true AO to the bound, which is a pixel's size; without, they are `gain`
// times as far off. The column is 15 pixels wide, of which each slice misses half a one at either edge.
TEST(Completion, what_stands_before_a_surface_hides_nothing_of_it) {
  const struct { double bound, gain; } limits[]{{0.002, 27}, {0.005, 20}, {0.001, 30}};
  const std::vector<Hiding> cases = hidings(320, 240);
  for (std::size_t k = 0; k < cases.size(); k++)
    for (const Shot& shot : {cases[k].perspective, cases[k].orthographic}) {
      SCOPED_TRACE(cases[k].what);
      const auto& [what, scene, radius, chosen, perspective, orthographic] = cases[k];
      const auto [bound, gain] = limits[k];
      const Rendering rendering = render(scene, shot);
      ReferenceSettings settings = thin(radius, Completion::all);
      settings.pixels = receivers(rendering, radius, kEvery, chosen);
      ASSERT_GE(settings.pixels.size(), 30u);
      std::vector<double> truth;
      for (const std::size_t i : settings.pixels)
        truth.push_back(true_ao(scene, rendering.hits[i], radius, kRaysAcross));
      const Errors all = errors_of(reference_ao(rendering.frame, settings), settings.pixels, truth);
      settings.complete = Completion::none;
      const Errors none = errors_of(reference_ao(rendering.frame, settings), settings.pixels, truth);
      EXPECT_LE(all.mean, bound) << "worst " << all.worst << ", not completed " << none.mean;
      EXPECT_LE(all.worst, 5 * bound);
      EXPECT_GE(none.mean, gain * bound);
    }
}

// What is blocked weighs by its distance, for which the segment is cut into parts; and bent normals lean away from it.
TEST(Completion, falloffs_and_bent_normals_take_what_goes_on) {
  const Rendering rendering = render(kPlateScene, Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, 320, 240));
  ReferenceSettings settings = thin(1, Completion::all);
  settings.pixels = receivers(rendering, 1, kEvery, is_floor_by_the_wall);
  const std::vector<Vec3> bent = first_band(reference_transfer(rendering.frame, settings));
  std::vector<double> truth;
  for (const std::size_t i : settings.pixels) {
    Vec3 open;
    truth.push_back(
        mean_over_rays(kPlateScene, rendering.hits[i], kRaysAcross, [&](const Hit& hit, const Vec3& direction) {
          if (hit.distance >= 1) open = open + direction;
          return std::min(1.0, hit.distance);
        }));
    const Vec3 mean = rendering.shot.view_from_world((1.0 / double(kRaysAcross * kRaysAcross)) * open);
    EXPECT_LE(length(mean - bent[i]), 0.01) << i;
  }
  settings.falloff = Falloff::linear;
  const Errors errors = errors_of(reference_ao(rendering.frame, settings), settings.pixels, truth);
  EXPECT_LE(errors.mean, 0.002);
  EXPECT_LE(errors.worst, 0.01);
}

// Where the wall is seen it is known, and it is taken to go on no farther than the column hides it. So what is blocked
// too much, or too little, is no more than the receiver sees of the part of the wall's plane that the column hides: of
// that without wall, or with it.
TEST(Completion, a_wall_that_ends_behind_a_column_errs_by_what_the_column_hides_at_most) {
  const EndingWall wall;
  const Rendering rendering = render(wall.scene, Shot::perspective(wall.eye, {0.3, 0, 0.6}, 50, 320, 240));
  ReferenceSettings settings = thin(1, Completion::all);
  settings.pixels =
      receivers(rendering, 1, kEvery, [](const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.5; });
  ASSERT_GE(settings.pixels.size(), 30u);
  const std::vector<float> ao = reference_ao(rendering.frame, settings);
  constexpr double kPixel = 0.015;  // what the size of pixels costs
  double largest = 0;
  for (const std::size_t i : settings.pixels) {
    const auto hidden = wall.hidden_from(rendering.hits[i], 1, kRaysAcross);
    const double truth = true_ao(wall.scene, rendering.hits[i], 1, kRaysAcross);
    EXPECT_GE(ao[i], truth - hidden.open - kPixel) << i << ", not wall " << hidden.open;
    EXPECT_LE(ao[i], truth + hidden.wall + kPixel) << i << ", wall " << hidden.wall;
    largest = std::max(largest, hidden.open);
  }
  EXPECT_GE(largest, 3 * kPixel);
}

// A picture of a wall whose upper part is cut off, against the whole.
TEST(Completion, beyond_the_border_a_wall_goes_on_as_in_a_wider_picture) {
  for (const Shot& shot : {Shot::perspective({5, 0.4, 1.8}, {0.3, 0, 0.6}, 50, 320, 240),
                           Shot::orthographic({5, 0.4, 1.8}, {0.3, 0, 0.6}, 5, 320, 240)}) {
    const CutWall wall(shot);
    ReferenceSettings settings = thin(1, Completion::none);
    settings.pixels = receivers(wall.whole, 1, kEvery, is_floor_by_the_wall);
    ASSERT_GE(settings.pixels.size(), 30u);
    const std::vector<float> expected = reference_ao(wall.whole.frame, settings);
    std::vector<double> truth;
    for (std::size_t& i : settings.pixels) {
      truth.push_back(expected[i]);
      i = wall.below(i);
    }
    const Errors none = errors_of(reference_ao(wall.frame, settings), settings.pixels, truth);
    EXPECT_GE(none.mean, 0.1) << shot.camera.orthographic;
    for (const Completion complete : {Completion::border, Completion::all}) {
      settings.complete = complete;
      const Errors errors = errors_of(reference_ao(wall.frame, settings), settings.pixels, truth);
      EXPECT_LE(errors.worst, 4e-3) << shot.camera.orthographic << ", completion " << int(complete);
    }
  }
}

TEST(Completion, of_a_thing_before_the_sky_changes_no_bit) {
  for (const HostFrame& frame : things_before_the_sky(60, 48)) {
    ReferenceSettings settings;
    settings.radius = 0.8;
    settings.slices = 8;
    settings.thickness = ThicknessRule::width;
    const std::vector<float> ao = reference_ao(frame, settings);
    const std::vector<float> transfer = reference_transfer(frame, settings);
    settings.complete = Completion::all;
    EXPECT_EQ(reference_ao(frame, settings), ao);
    EXPECT_EQ(reference_transfer(frame, settings), transfer);
    EXPECT_EQ(reference_completed(frame, settings), std::vector<float>(ao.size(), 0.0f));
  }
}

TEST(Completion, never_opens_what_was_blocked) {
  RandomScenes scenes(7);
  double border_share = 0, all_share = 0;
  for (int i = 0; i < 12; i++) {
    const HostFrame frame = scenes.next();
    if (frame.normal.empty()) continue;
    ReferenceSettings settings = thin(0.7, Completion::none);
    settings.thickness_length = 0.1;
    settings.slices = 4;
    const std::vector<float> none = reference_ao(frame, settings);
    settings.complete = Completion::border;
    const std::vector<float> border = reference_ao(frame, settings);
    const std::vector<float> beyond_border = reference_completed(frame, settings);
    settings.complete = Completion::all;
    const std::vector<float> all = reference_ao(frame, settings);
    const std::vector<float> completed = reference_completed(frame, settings);
    for (std::size_t k = 0; k < all.size(); k++) {
      ASSERT_LE(border[k], none[k]) << i << " pixel " << k;
      ASSERT_LE(all[k], none[k]) << i << " pixel " << k;
      // To complete surfaces behind others, more samples are looked at, and near the edge of the sphere a few count.
      ASSERT_NEAR(completed[k], none[k] - all[k], 5e-3) << i << " pixel " << k;
      ASSERT_NEAR(beyond_border[k], none[k] - border[k], 2e-7) << i << " pixel " << k;
      border_share += none[k] - border[k];
      all_share += completed[k];
    }
  }
  EXPECT_GE(border_share, 1);
  EXPECT_GE(all_share, 1.1 * border_share);
}

}  // namespace
}  // namespace alcove::reference_completion_test
