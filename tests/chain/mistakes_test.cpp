// Mistakes that designs of screen-space AO make, each with a test that fails if this tool makes it.
// SPDX-License-Identifier: BSD-3-Clause
//
// Here:
// - the arc integral in a wrong form; slices not weighted by the projected normal; slices against the normal or a
//   constant axis instead of the view ray; the normal's angle with the wrong sign:
//   Gtao.beside_a_wall_is_right_at_every_tilt
// - the two sides of a slice subtracted: Gtao.sums_both_sides_of_a_slice
// - one side's horizon clamped or started as the other's; rows counted upwards: EveryEstimator.is_the_same_to_all_sides
// - visibility inverted, or blended towards less than nothing:
//   EveryEstimator.is_open_where_nothing_is_and_darker_where_something_is
// - horizons clamped to +-90 degrees of the view ray instead of the normal: Gtao.beside_a_wall_is_right_at_every_tilt
// - a slope that blocks itself: EveryEstimator.leaves_a_tilted_plane_open
// - the radius taken for pixels: EveryEstimator.reaches_as_far_at_every_resolution
// - sky that is cleared to 0, infinite or NaN and taken for a surface: EveryEstimator.takes_no_sky_for_a_surface
// - normals of length 0, or encoded, that make NaN: EveryEstimator.stays_finite_on_broken_normals
// - distance to the eye taken for planar depth: EveryEstimator.knows_ray_depth_from_planar
// - an 8-bit result before the intensity: EveryEstimator.has_more_levels_than_8_bits_after_a_large_intensity
// - samples behind the eye, off the image or before the sky that count:
//   Crytek.counts_only_samples_before_the_eye_and_on_the_image, Crytek.counts_no_samples_before_the_sky
// - a basis about the normal that degenerates: Crytek.has_a_basis_about_every_normal
// - depth compared with the receiver's instead of the sample's: Crytek.compares_depth_with_the_sample_not_the_receiver
// - a kernel whose noise fits one resolution: EveryEstimator.has_its_noise_by_pixel_at_every_resolution
// Elsewhere:
// - horizons of HBAO as angles to the normal, 1 - sin h: estimator_test Hbao.beside_*,
//   Hbao.sees_the_uniform_hemisphere_at_every_tilt_of_the_view
// - even directions of the image taken for even slices: estimator_test Hbao.off_axis_is_what_it_is_on_axis;
//   closed_form_test, "wide"
// - hits weighed by the cosine to the normal under the name of Crytek: estimator_test
//   Crytek.beside_an_endless_wall_is_the_volume_before_it
// - a range check that loses hits within the radius without anybody having asked for it, or divides 0 by 0:
//   estimator_test Crytek.range_checks_*
// - biases and thresholds in absolute units: estimator_test EveryVariant.gives_the_same_bits_twice_and_at_every_scale;
//   property_test Scale.*
// - falloff towards the wrong horizon: closed_form_test FalloffForm.*
// - normals in world space called view space: property_test NormalSpace.*; intensity as factor and exponent at once:
//   property_test Shape.*
// - AO on direct light: command_line_test, the composite; random numbers that differ by machine: property_test
//   Repetition.*
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/chain/compute.h"
#include "core/reference/reference_estimators.h"
#include "tests/support/block_scene.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"

namespace alcove {
namespace {

using test::block, test::leaning;
using test::Difference, test::difference, test::place, test::same_bits;
using test::Plane, test::Rendering, test::Scene, test::Shot, test::Sphere, test::unit, test::Vec3;

EstimatorSettings settings_of(Estimator estimator, double radius, int slices = 16, int steps = 64) {
  EstimatorSettings settings = test::plain_settings();
  settings.estimator = estimator;
  settings.radius = radius;
  settings.slices = slices;
  settings.steps = steps;
  settings.samples = 64;
  settings.sample_kernel = SampleKernel::uniform;
  return settings;
}

constexpr Estimator kEstimators[]{Estimator::gtao, Estimator::hbao, Estimator::crytek};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

std::string name_of(Estimator estimator) { return "estimator " + std::to_string(int(estimator)); }

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(test::recorder(), frame, settings).ao;
}

/// The mean over the floor's pixels at about that distance from the block, in the middle of the picture.
double beside_block(const Rendering& rendering, const EstimatorSettings& settings, double d, double half_band = 0.025) {
  const std::vector<float> ao = run(rendering.frame, settings);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    const test::Hit& hit = rendering.hits[i];
    if (hit.primitive != 0 || std::abs(hit.position.x - d) > half_band || std::abs(hit.position.y) > 0.3) continue;
    sum += ao[i];
    count++;
  }
  EXPECT_GE(count, 10);
  return sum / count;
}

// GTAO. The rim of a block as high as it is far stands at 45 degrees: (1 + cos 45) / 2 is open.

const double kBelow45 = (1 + std::sqrt(0.5)) / 2;

TEST(Gtao, beside_a_wall_is_right_at_every_tilt) {
  for (const double tilt : {0.0, 30.0, 60.0, 75.0}) {
    Shot shot = leaning(tilt, 6, 300, 160);
    shot.camera.fy = 160 / 16.0;  // px oblong in y: the picture shows eight times the distance to each side
    EXPECT_NEAR(beside_block(test::render(block(1), shot), settings_of(Estimator::gtao, 1e3, 16, 512), 1, 0.1),
                kBelow45, 0.01)
        << "tilt " << tilt;
  }
}

TEST(Gtao, sums_both_sides_of_a_slice) {
  Scene trench = block(0.5);
  trench.primitives.emplace_back(test::parallelogram({1, -100, 0.5}, {0, 200, 0}, {100, 0, 0}));
  const double ao =
      beside_block(test::render(trench, leaning(0, 3, 150, 150)), settings_of(Estimator::gtao, 1e3, 32, 256), 0.5);
  EXPECT_NEAR(ao, 2 * kBelow45 - 1, 0.02);
}

// Every estimator.

TEST(EveryEstimator, is_the_same_to_all_sides) {
  for (const Estimator estimator : kEstimators)
    for (const double tilt : {0.0, 35.0}) {
      std::vector<double> means;
      for (const double turn : {0.0, 90.0, 180.0, 270.0})
        means.push_back(
            beside_block(test::render(block(0.4), leaning(tilt, 3, 200, 200, turn)), settings_of(estimator, 0.6), 0.2));
      EXPECT_LE(std::ranges::max(means) - std::ranges::min(means), 0.01) << name_of(estimator) << " tilt " << tilt;
      EXPECT_LE(std::ranges::max(means), 0.92) << name_of(estimator) << " tilt " << tilt;
    }
}

TEST(EveryEstimator, is_open_where_nothing_is_and_darker_where_something_is) {
  const Rendering rendering = test::render(block(0.5), leaning(30, 4, 240, 120));
  for (const Estimator estimator : kEstimators)
    for (const Falloff falloff : {Falloff::none, Falloff::linear}) {
      EstimatorSettings settings = settings_of(estimator, 0.5);
      settings.falloff = falloff;
      const double near = beside_block(rendering, settings, 0.05), middle = beside_block(rendering, settings, 0.3);
      EXPECT_NEAR(beside_block(rendering, settings, 1), 1, 1e-6) << name_of(estimator);
      EXPECT_LT(near, middle - 0.05) << name_of(estimator);
      EXPECT_LT(middle, 0.999) << name_of(estimator);
      EXPECT_GT(near, 0.45) << name_of(estimator) << ": half of the hemisphere at most is blocked";
    }
}

TEST(EveryEstimator, leaves_a_tilted_plane_open) {
  for (const double tilt : {20.0, 50.0, 75.0}) {
    const Vec3 normal{-std::cos(tilt * std::numbers::pi / 180), 0.6 * std::sin(tilt * std::numbers::pi / 180),
                      0.8 * std::sin(tilt * std::numbers::pi / 180)};
    const Rendering rendering =
        test::render({{Plane{.point = {5, 0, 0}, .normal = normal}}}, Shot::perspective({}, {1, 0, 0}, 70, 120, 90));
    for (const Estimator estimator : kEstimators) {
      const Difference d = difference(run(rendering.frame, settings_of(estimator, 2)), [](std::size_t) { return 1.0; });
      EXPECT_LE(d.max, 1e-4) << name_of(estimator) << " tilt " << tilt << ", " << place(d, rendering.frame);
    }
  }
}

TEST(EveryEstimator, reaches_as_far_at_every_resolution) {
  for (const Estimator estimator : kEstimators) {
    const auto at = [&](int width, double d) {
      return beside_block(test::render(block(2), leaning(20, 3, width, width / 2)), settings_of(estimator, 0.5), d);
    };
    const double coarse = at(150, 0.25), fine = at(600, 0.25);
    EXPECT_NEAR(coarse, fine, 0.015) << name_of(estimator);
    EXPECT_LT(fine, 0.93) << name_of(estimator);
    EXPECT_NEAR(at(150, 0.56), 1, 1e-6) << name_of(estimator);
    EXPECT_NEAR(at(600, 0.56), 1, 1e-6) << name_of(estimator);
  }
}

/// A floor, a ball on it, and sky.
Rendering ball_before_sky(int width = 120, int height = 90) {
  const Scene scene{
      {test::parallelogram({0, -2, 0}, {3, 0, 0}, {0, 4, 0}), Sphere{.center = {1.2, 0.3, 0.5}, .radius = 0.5}}};
  return test::render(scene, Shot::perspective({4.5, -1.5, 1.6}, {1, 0, 0.6}, 50, width, height));
}

TEST(EveryEstimator, takes_no_sky_for_a_surface) {
  const Rendering rendering = ball_before_sky();
  const Sphere alone{.center = {6, 0.4, -0.3}, .radius = 1.5};
  HostFrame convex = test::render({{alone}}, Shot::perspective({}, {1, 0, 0}, 50, 120, 90)).frame;
  for (const Estimator estimator : kEstimators) {
    const std::vector<float> expected = run(rendering.frame, settings_of(estimator, 0.8));
    for (const float mark : {0.0f, -1.0f, kInfinity, -kInfinity, kNan, 1e30f}) {
      HostFrame frame = rendering.frame, ball = convex;
      std::ranges::replace(frame.depth, test::kSky, mark);
      std::ranges::replace(ball.depth, test::kSky, mark);
      EXPECT_TRUE(same_bits(run(frame, settings_of(estimator, 0.8)), expected))
          << name_of(estimator) << " sky " << mark;
      EXPECT_LE(difference(run(ball, settings_of(estimator, 3)), [](std::size_t) { return 1.0; }).max, 1e-4)
          << name_of(estimator) << " sky " << mark;
    }
    for (std::size_t i = 0; i < expected.size(); i++)
      if (rendering.hits[i].primitive < 0) ASSERT_EQ(expected[i], 1) << name_of(estimator);
  }
}

TEST(EveryEstimator, stays_finite_on_broken_normals) {
  const Rendering rendering = ball_before_sky();
  HostFrame without = rendering.frame;
  without.normal.clear();
  for (const Estimator estimator : kEstimators) {
    const std::vector<float> expected = run(without, settings_of(estimator, 0.8));
    EXPECT_LT(*std::ranges::min_element(expected), 0.9f) << name_of(estimator) << ": there is something to see";
    for (const float broken : {0.0f, kNan, kInfinity, 1e-30f}) {
      HostFrame frame = rendering.frame;
      std::ranges::fill(frame.normal, broken);
      EXPECT_TRUE(same_bits(run(frame, settings_of(estimator, 0.8)), expected)) << name_of(estimator) << " " << broken;
    }
  }
}

TEST(EveryEstimator, knows_ray_depth_from_planar) {
  const Rendering rendering =
      test::render({{Plane{.point = {5, 0, 0}, .normal = {-1, 0, 0}}}}, Shot::perspective({}, {1, 0, 0}, 110, 160, 90));
  HostFrame frame = rendering.frame;
  for (std::size_t i = 0; i < frame.depth.size(); i++) frame.depth[i] = float(length(rendering.hits[i].position));
  for (const Estimator estimator : kEstimators) {
    frame.depth_kind = DepthKind::ray;
    EXPECT_LE(difference(run(frame, settings_of(estimator, 2)), [](std::size_t) { return 1.0; }).max, 1e-3)
        << name_of(estimator);
    frame.depth_kind = DepthKind::planar;  // the plane becomes a bowl
    EXPECT_GT(difference(run(frame, settings_of(estimator, 2)), [](std::size_t) { return 1.0; }).max, 0.02)
        << name_of(estimator);
  }
}

TEST(EveryEstimator, has_more_levels_than_8_bits_after_a_large_intensity) {
  const Rendering rendering = test::render(block(0.1), leaning(30, 3, 240, 180));
  for (const Estimator estimator : kEstimators) {
    EstimatorSettings settings = settings_of(estimator, 1, 16, 64);
    settings.intensity = 13;
    std::set<float> levels;
    for (const float ao : run(rendering.frame, settings))
      if (ao > 0 && ao < 1) levels.insert(ao);
    EXPECT_GT(levels.size(), 255 / 13) << name_of(estimator);
  }
}

TEST(EveryEstimator, has_its_noise_by_pixel_at_every_resolution) {
  // The noise of a few samples: over any 8 x 8 pixels nearly all of it averages out, however large the picture is.
  for (const int width : {64, 160, 2400}) {
    const Rendering rendering = test::render(block(2), leaning(30, 2.0 * width / 64, width, 24));
    for (const Estimator estimator : kEstimators) {
      EstimatorSettings few = settings_of(estimator, 0.5, 1, 4);
      few.samples = 4;
      const std::vector<float> ao = run(rendering.frame, few), fine = run(rendering.frame, settings_of(estimator, 0.5));
      double noise = 0, left = 0;
      for (int y = 0; y + 8 <= 24; y += 8)
        for (int x = 0; x + 8 <= width; x += 8) {
          double sum = 0;
          for (int v = 0; v < 8; v++)
            for (int u = 0; u < 8; u++) {
              const auto i = std::size_t((y + v) * width + x + u);
              sum += (ao[i] - fine[i]) / 64;
              noise += std::pow(ao[i] - fine[i], 2) / 64;
            }
          left += sum * sum;
        }
      EXPECT_GT(noise, 0.01) << name_of(estimator) << ": there is noise to average";
      EXPECT_LT(left, 0.3 * noise) << name_of(estimator) << " width " << width << ": " << left << " of " << noise;
    }
  }
}

// Crytek's estimator.

/// The kernel against its slow version at some pixels: the mean error and the largest.
void expect_as_reference(const HostFrame& frame, const EstimatorSettings& settings, double mean, double largest,
                         const std::string& what) {
  std::vector<std::size_t> pixels;
  for (std::size_t i = 3; i < frame.depth.size(); i += 23) pixels.push_back(i);
  const std::vector<float> ao = run(frame, settings), slow = reference_estimate(frame, settings, pixels);
  double bias = 0, worst = 0;
  for (const std::size_t i : pixels) {
    bias += (ao[i] - slow[i]) / double(pixels.size());
    worst = std::max(worst, double(std::abs(ao[i] - slow[i])));
  }
  EXPECT_LE(std::abs(bias), mean) << what;
  EXPECT_LE(worst, largest) << what;
}

TEST(Crytek, counts_only_samples_before_the_eye_and_on_the_image) {
  // The eye is so near to a corner that many samples are behind it and more off the image.
  const Scene corner{{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}}}};
  const Rendering rendering = test::render(corner, Shot::perspective({0.12, 0, 0.1}, {0, 0.05, 0.02}, 70, 96, 72));
  for (const double radius : {0.1, 0.15, 0.2})
    expect_as_reference(rendering.frame, settings_of(Estimator::crytek, radius), 0.01, 0.4,
                        "in a corner, radius " + std::to_string(radius));
  // A wall that covers all of the picture's left: beyond the picture's border nothing is known, so the border is no
  // brighter than the middle.
  const Rendering wall = test::render(block(5), leaning(30, 1, 96, 72));
  const std::vector<float> ao = run(wall.frame, settings_of(Estimator::crytek, 0.5));
  double border = 0, middle = 0;
  int columns = 0;
  for (int x = 0; x < 96; x++) {
    if (wall.at(x, 36).primitive != 0 || wall.at(x, 36).position.x > 0.3) continue;
    columns++;
    for (int y = 0; y < 4; y++)
      border += ao[std::size_t(y * 96 + x)] / 4, middle += ao[std::size_t((y + 34) * 96 + x)] / 4;
  }
  ASSERT_GT(columns, 10);
  EXPECT_NEAR(border / columns, middle / columns, 0.02);
}

TEST(Crytek, counts_no_samples_before_the_sky) {
  expect_as_reference(ball_before_sky().frame, settings_of(Estimator::crytek, 0.8), 0.003, 0.25,
                      "a ball before the sky");
}

TEST(Crytek, has_a_basis_about_every_normal) {
  // Inside of a ball, seen from its middle through a wide angle and from its rim, normals point everywhere; all are
  // alike: the hidden volume is the same.
  const Sphere ball{.center = {}, .radius = 2};
  for (const Shot& shot :
       {Shot::perspective({}, {1, 0, 0}, 130, 120, 120), Shot::perspective({-1.9, 0, 0}, {1, 0, 0}, 130, 120, 120)}) {
    const Rendering rendering = test::render({{ball}}, shot);
    const std::vector<float> ao = run(rendering.frame, settings_of(Estimator::crytek, 0.5));
    // A ball of radius R about a point of the sphere S: below the tangent's cap lies R / S * 3 / 16 of the half ball's
    // volume.
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < ao.size(); i++) {
      if (!shot.sees_ball(rendering.hits[i].position, 0.5)) continue;
      sum += ao[i];
      count++;
      EXPECT_NEAR(ao[i], 1 - 0.25 * 3 * 0.5 / 4, 0.15);
    }
    ASSERT_GT(count, 100);
    EXPECT_NEAR(sum / count, 1 - 3 * 0.5 / (8 * 2), 0.01);
  }
}

TEST(Crytek, compares_depth_with_the_sample_not_the_receiver) {
  // On a floor that is seen aslant the far half of the hemisphere is deeper than the receiver, the near half less; a
  // block behind, which no sample is within, hides nothing.
  const Rendering rendering = test::render(block(0.5), leaning(60, 4, 240, 120));
  EstimatorSettings settings = settings_of(Estimator::crytek, 0.3);
  settings.range_check = RangeCheck::none;
  EXPECT_NEAR(beside_block(rendering, settings, 0.4), 1, 1e-6);
  // c = 0.5: (1 - c)^2 (2 + c) / 4 is hidden
  EXPECT_NEAR(beside_block(rendering, settings, 0.15, 0.02), 1 - 0.25 * 2.5 / 4, 0.01);
}

}  // namespace
}  // namespace alcove
