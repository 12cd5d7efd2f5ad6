// What is left out has the bits of what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/base/estimator_facts.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/random_scenes.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using namespace test;

struct Outcome {
  std::vector<float> values;  // AO of all scales, and the bent normals
  TileCounts tiles{};
};

Outcome run(const HostFrame& frame, EstimatorSettings settings, bool no_skip) {
  settings.no_skip = no_skip;
  OutputSettings output;
  output.aovs = searches_slices(settings) ? "ao,bent-normal,ao-scales" : "ao,ao-scales";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  recorder().run();
  Outcome outcome;
  for (const auto* planes : {outputs.ao, outputs.scales, outputs.bent_normal}) {
    if (!planes) continue;
    const auto values = planes->as<float>();
    outcome.values.insert(outcome.values.end(), values.begin(), values.end());
  }
  outcome.tiles = outputs.tiles->as<TileCounts>()[0];
  return outcome;
}

/// A room whose upper part is sky, with a border of single pixels.
HostFrame room_before_sky(int width, int height) {
  HostFrame frame = furnished_room(width, height).frame;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      if (y < height / 3 + x % 3) frame.depth[std::size_t(y * width + x)] = kSky;
  return frame;
}

EstimatorSettings settings_of(Estimator estimator, double radius) {
  EstimatorSettings settings = plain_settings();
  settings.estimator = estimator;
  settings.radius = radius;
  settings.slices = 2;
  settings.steps = 6;
  settings.samples = 16;
  return settings;
}

void expect_same(const HostFrame& frame, const EstimatorSettings& settings, const std::string& what) {
  const Outcome skipped = run(frame, settings, false), whole = run(frame, settings, true);
  EXPECT_EQ(whole.tiles.sky, 0u) << what;
  EXPECT_EQ(skipped.tiles.sky + skipped.tiles.listed, whole.tiles.listed) << what;
  EXPECT_TRUE(same_bits(skipped.values, whole.values)) << what;
}

TEST(Skip, sky_is_left_out_for_any_estimator_density_and_resolution) {
  const HostFrame frame = room_before_sky(157, 119);
  ASSERT_GE(run(frame, settings_of(Estimator::gtao, 0.3), false).tiles.sky, 80u);
  for (const Estimator estimator : kEstimators)
    expect_same(frame, settings_of(estimator, 0.3), "estimator " + std::to_string(int(estimator)));
  EstimatorSettings settings = settings_of(Estimator::gtao, 0.4);
  settings.further_radii = {0.1, 0.02};
  expect_same(frame, settings, "scales");
  settings = settings_of(Estimator::gtao, 0.4);
  settings.denoise = Denoise::bilateral;
  for (const Density density : {Density::uniform, Density::adaptive})
    for (const int stride : {2, 4, 8, 16}) {
      settings.density = density;
      settings.stride = stride;
      expect_same(frame, settings, fmt::format("stride {}, density {}", stride, int(density)));
    }
  settings.stride = 1;
  for (const auto resolution : {Resolution::half, Resolution::quarter}) {
    settings.resolution = resolution;
    expect_same(frame, settings, "resolution " + std::to_string(int(resolution)));
  }
}

TEST(Skip, sky_is_open) {
  HostFrame frame = furnished_room(160, 120).frame;
  std::ranges::fill(frame.depth, kSky);
  const Outcome sky = run(frame, settings_of(Estimator::gtao, 0.3), false);
  EXPECT_EQ(sky.tiles.listed, 0u);
  EXPECT_EQ(sky.tiles.sky, 300u);
  for (std::size_t i = 0; i < frame.data.pixels(); i++) ASSERT_EQ(sky.values[i], 1.0f);
}

// An estimate by its error leaves out sky by itself; beside it stand the estimates of confidence, and a frame of sky.
TEST(Skip, estimates_by_their_error) {
  HostFrame frame = furnished_room(80, 60).frame;
  EstimatorSettings settings;
  settings.radius = 0.3;
  settings.slices = 3;
  settings.tolerance = 0.05;
  OutputSettings output;
  const auto planes = [&](bool no_skip) {
    settings.no_skip = no_skip;
    const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
    recorder().run();
    std::vector<float> values;
    for (const auto* plane : {outputs.ao, outputs.scales, outputs.error, outputs.confidence})
      if (plane) values.insert(values.end(), plane->as<float>().begin(), plane->as<float>().end());
    return values;
  };
  for (const bool is_sky : {false, true}) {
    if (is_sky) std::ranges::fill(frame.depth, kSky);
    for (const std::string aovs : {"ao,ao-scales", "ao,error,confidence"}) {
      output.aovs = aovs;
      const std::vector<float> skipped = planes(false);
      EXPECT_EQ(recorder().passes().empty(), is_sky && aovs == "ao,ao-scales") << aovs;
      EXPECT_TRUE(same_bits(skipped, planes(true))) << aovs << (is_sky ? " of sky" : "");
    }
  }
}

TEST(Skip, a_frame_of_sky_needs_no_kernel) {
  HostFrame frame = furnished_room(70, 50).frame;
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.3;
  settings.further_radii = {0.1};
  settings.power = 1.4;
  settings.denoise = Denoise::bilateral;
  for (const auto resolution : {Resolution::full, Resolution::quarter}) {
    settings.resolution = resolution;
    for (const float sky : {0.0f, 1e9f, std::numeric_limits<float>::infinity()}) {
      std::ranges::fill(frame.depth, sky);
      const HostResult skipped = compute_ao(recorder(), frame, settings);
      EXPECT_TRUE(recorder().passes().empty());
      settings.no_skip = true;
      const HostResult whole = compute_ao(recorder(), frame, settings);
      settings.no_skip = false;
      EXPECT_FALSE(recorder().passes().empty());
      EXPECT_TRUE(same_bits(skipped.ao, whole.ao));
      EXPECT_EQ(skipped.sky_pixels, whole.sky_pixels);
    }
    for (const float other : {std::numeric_limits<float>::quiet_NaN(), -1.0f, 5.0f}) {
      frame.depth[1234] = other;
      const HostResult result = compute_ao(recorder(), frame, settings);
      EXPECT_FALSE(recorder().passes().empty()) << other;
      EXPECT_EQ(result.sky_pixels, other > 0 ? 3499u : 3500u);
      EXPECT_EQ(result.repaired_depth, other > 0 ? 0u : 1u);
    }
  }
}

TEST(Skip, any_bits_as_input) {
  for (unsigned seed = 0; seed < 60; seed++) {
    const int width = 1 + int(seed * 7 % 90), height = 1 + int(seed * 13 % 50);
    const HostFrame frame = random_bits(width, height, seed);
    for (const Estimator estimator : kEstimators) {
      EstimatorSettings settings = settings_of(estimator, 0.5);
      settings.denoise = seed % 2 ? Denoise::bilateral : Denoise::none;
      expect_same(frame, settings, "seed " + std::to_string(seed));
    }
  }
}

}  // namespace
}  // namespace alcove
