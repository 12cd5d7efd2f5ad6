// Estimates by their error: as many directions as the tolerance takes.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/scenes.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using namespace test;

struct Outcome {
  std::vector<float> ao, error;
  double estimate = 0;  // of the whole frame's RMS error
};

Outcome run(const HostFrame& frame, double radius, double tolerance) {
  EstimatorSettings settings;
  settings.radius = radius;
  settings.tolerance = tolerance;
  OutputSettings output;
  output.aovs = "ao,error";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  recorder().run();
  const auto ao = outputs.ao->as<float>(), error = outputs.error->as<float>();
  double sum = 0, receivers = 0;
  for (const vec2& tile : outputs.squares->as<const vec2>()) sum += tile.x, receivers += tile.y;
  return {{ao.begin(), ao.end()}, {error.begin(), error.end()}, std::sqrt(sum / std::max(receivers, 1.0))};
}

std::vector<float> truth_of(const HostFrame& frame, double radius) {
  EstimatorSettings settings = plain_settings();
  settings.radius = radius;
  settings.thickness = ThicknessKind::automatic;
  settings.search = SliceSearch::exact;
  settings.slices = 64;
  return compute_ao(recorder(), frame, settings).ao;
}

double rms_error(const HostFrame& frame, const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); i++)
    if (frame.depth[i] < kSky) sum += std::pow(a[i] - b[i], 2), count++;
  return std::sqrt(sum / double(count));
}

TEST(Tolerance, is_kept_and_the_estimate_says_so) {
  const Rendering room = furnished_room(173, 131);
  const std::vector<float> truth = truth_of(room.frame, 0.6);
  double last = 1;
  for (const double tolerance : {0.05, 0.02, 0.01}) {
    const Outcome outcome = run(room.frame, 0.6, tolerance);
    const double error = rms_error(room.frame, outcome.ao, truth);
    EXPECT_LE(error, 1.1 * tolerance);
    EXPECT_LE(outcome.estimate, tolerance);
    EXPECT_GT(outcome.estimate, error / 2) << "neither too sure of itself";
    EXPECT_LT(outcome.estimate, error * 3) << "nor too little";
    EXPECT_LT(error, last);
    last = error;
  }
}

TEST(Tolerance, error_is_largest_where_the_estimate_is_worst) {
  const Rendering room = furnished_room(173, 131);
  const std::vector<float> truth = truth_of(room.frame, 0.6);
  const Outcome outcome = run(room.frame, 0.6, 0.1);
  double sure = 0, unsure = 0, sures = 0, unsures = 0;
  for (std::size_t i = 0; i < truth.size(); i++) {
    if (room.frame.depth[i] >= kSky) {
      EXPECT_EQ(outcome.error[i], 0.0f);
      continue;
    }
    EXPECT_GE(outcome.error[i], 0.0f);
    EXPECT_LE(outcome.error[i], 0.1f) << "converged at most 64 directions";
    const double squared = std::pow(outcome.ao[i] - truth[i], 2);
    (outcome.error[i] < 0.01 ? sure : unsure) += squared;
    (outcome.error[i] < 0.01 ? sures : unsures)++;
  }
  ASSERT_GT(sures, 1000);
  ASSERT_GT(unsures, 1000);
  EXPECT_LT(sure / sures, 0.25 * unsure / unsures);
}

TEST(Tolerance, a_floor_is_open) {
  const Scene scene{{parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0})}};
  const Rendering floor = render(scene, Shot::perspective({0, -3, 2}, {0, 0, 0}, 60, 61, 47));
  const Outcome outcome = run(floor.frame, 0.5, 0.01);
  for (const float value : outcome.ao) ASSERT_NEAR(value, 1, 1e-4);
  EXPECT_LT(outcome.estimate, 1e-4);
}

TEST(Tolerance, has_the_same_bits_on_every_run) {
  const Rendering room = furnished_room(101, 77);
  const Outcome first = run(room.frame, 0.6, 0.02);
  for (int i = 0; i < 3; i++) {
    const Outcome again = run(room.frame, 0.6, 0.02);
    EXPECT_TRUE(same_bits(again.ao, first.ao));
    EXPECT_TRUE(same_bits(again.error, first.error));
  }
}

TEST(Tolerance, radii_are_each_estimated_by_their_error) {
  const Rendering room = furnished_room(101, 77);
  EstimatorSettings settings;
  settings.radius = 0.6;
  settings.further_radii = {0.2};
  settings.tolerance = 0.02;
  OutputSettings output;
  output.aovs = "ao-scales";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), room.frame), settings, output);
  recorder().run();
  const auto planes = outputs.scales->as<float>();
  const std::vector<float> scales(planes.begin(), planes.end());
  const std::size_t pixels = room.frame.data.pixels();
  EXPECT_TRUE(same_bits({scales.begin(), scales.begin() + std::ptrdiff_t(pixels)}, run(room.frame, 0.2, 0.02).ao));
  EXPECT_TRUE(same_bits({scales.begin() + std::ptrdiff_t(pixels), scales.end()}, run(room.frame, 0.6, 0.02).ao));
}

}  // namespace
}  // namespace alcove
