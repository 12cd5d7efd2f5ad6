// What is left out has the bits of what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "tests/support/chain.h"
#include "tests/support/scenes.h"
#include "tests/support/site_frames.h"

namespace alcove::skip_test {
namespace {

using namespace test;

/// AO of all scales and, where the estimator has them, bent normals; computed with what may be skipped, or without.
Planes run(const HostFrame& frame, EstimatorSettings settings, bool no_skip) {
  settings.no_skip = no_skip;
  return planes_of(frame, settings,
                   searches_slices(settings) ? "ao,bent-normal,transfer,ao-scales,cavity" : "ao,ao-scales,cavity");
}

/// A room with strands before it, whose upper part is sky, with a border of single pixels.
HostFrame room_before_sky(int width, int height) {
  HostFrame frame = furnished_room(width, height).frame;
  add_strands(frame);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      if (y < height / 3 + x % 3) frame.depth[std::size_t(y * width + x)] = kSky;
  return frame;
}

EstimatorSettings settings_of(Estimator estimator, double radius) {
  EstimatorSettings settings = sampled(estimator, radius, 2, 6);
  settings.samples = 16;
  return settings;
}

void expect_same(const HostFrame& frame, const EstimatorSettings& settings) {
  SCOPED_TRACE(name_of(settings));
  const Planes skipped = run(frame, settings, false), whole = run(frame, settings, true);
  EXPECT_EQ(whole.tiles.sky, 0u);
  EXPECT_EQ(skipped.tiles.sky + skipped.tiles.listed, whole.tiles.listed);
  EXPECT_TRUE(same_bits(skipped.ao, whole.ao));
  EXPECT_TRUE(same_bits(skipped.scales, whole.scales));
  EXPECT_TRUE(same_bits(skipped.bent, whole.bent));
  EXPECT_TRUE(same_bits(skipped.transfer, whole.transfer));
  EXPECT_TRUE(same_bits(skipped.cavity, whole.cavity));
}

TEST(Skip, sky_is_left_out_for_any_estimator_density_and_resolution) {
  const HostFrame frame = room_before_sky(157, 119);
  ASSERT_GE(run(frame, settings_of(Estimator::gtao, 0.3), false).tiles.sky, 80u);
  for (const Estimator estimator : kEstimators) expect_same(frame, settings_of(estimator, 0.3));
  EstimatorSettings settings = settings_of(Estimator::gtao, 0.4);
  settings.further_radii = {0.1, 0.02};
  expect_same(frame, settings);
  settings = settings_of(Estimator::gtao, 0.4);
  settings.denoise = Denoise::bilateral;
  for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask})
    for (const Density density : {Density::uniform, Density::adaptive})
      for (const int stride : {2, 4, 8, 16}) {
        settings.estimator = estimator;
        settings.density = density;
        settings.stride = stride;
        expect_same(frame, settings);
      }
  settings.stride = 1;
  for (const auto resolution : {Resolution::half, Resolution::quarter}) {
    settings.resolution = resolution;
    expect_same(frame, settings);
  }
}

// An estimate by its error leaves out sky by itself; beside it stand the estimates of confidence, and a frame of sky.
TEST(Skip, estimates_by_their_error) {
  HostFrame frame = furnished_room(80, 60).frame;
  EstimatorSettings settings;
  settings.radius = 0.3;
  settings.slices = 3;
  settings.tolerance = 0.05;
  for (const bool is_sky : {false, true}) {
    if (is_sky) std::ranges::fill(frame.depth, kSky);
    for (const std::string aovs : {"ao,ao-scales", "ao,error,confidence"}) {
      settings.no_skip = false;
      const Planes skipped = planes_of(frame, settings, aovs);
      settings.no_skip = true;
      const Planes whole = planes_of(frame, settings, aovs);
      SCOPED_TRACE(aovs + (is_sky ? " of sky" : ""));
      EXPECT_EQ(skipped.passes.empty(), is_sky && aovs == "ao,ao-scales");
      for (const auto planes : {&Planes::ao, &Planes::scales, &Planes::error, &Planes::confidence})
        EXPECT_TRUE(same_bits(skipped.*planes, whole.*planes));
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
    for (const float sky : {0.0f, 1e9f, kInfinity}) {
      std::ranges::fill(frame.depth, sky);
      const HostResult skipped = compute_ao(recorder(), frame, settings);
      EXPECT_TRUE(recorder().passes().empty());
      settings.no_skip = true;
      const HostResult whole = compute_ao(recorder(), frame, settings);
      settings.no_skip = false;
      EXPECT_FALSE(recorder().passes().empty());
      EXPECT_TRUE(same_bits(skipped.ao, whole.ao));
      EXPECT_EQ(skipped.ao, std::vector<float>(frame.depth.size(), 1.0f));
      EXPECT_EQ(skipped.sky_pixels, whole.sky_pixels);
    }
    for (const float other : {kNan, -1.0f, 5.0f}) {
      frame.depth[1234] = other;
      const HostResult result = compute_ao(recorder(), frame, settings);
      EXPECT_FALSE(recorder().passes().empty()) << other;
      EXPECT_EQ(result.sky_pixels, other > 0 ? 3499u : 3500u);
      EXPECT_EQ(result.repaired_depth, other > 0 ? 0u : 1u);
    }
  }
}

TEST(Skip, any_bits_as_input) {
  for (unsigned seed = 0; seed < (long_tests() ? 60 : 24); seed++) {
    SCOPED_TRACE(seed);
    const HostFrame frame = random_bits(1 + int(seed * 7 % 90), 1 + int(seed * 13 % 50), seed);
    for (const Estimator estimator : kEstimators) {
      EstimatorSettings settings = settings_of(estimator, 0.5);
      settings.denoise = seed % 2 ? Denoise::bilateral : Denoise::none;
      expect_same(frame, settings);
    }
  }
}

}  // namespace
}  // namespace alcove::skip_test
