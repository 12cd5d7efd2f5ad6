// Depth that was blurred across outlines has surfaces of its own there; cut, its pixels lie on those of the scene.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/ramps.h"

#include <cmath>
#include <limits>

#include "core/base/system.h"
#include "tests/support/test.h"

namespace alcove::ramps_test {
namespace {

using namespace test;

constexpr int kWidth = 120, kHeight = 90;
constexpr float kNoSurface = 1e10f;

/// A round thing before a slanted wall.
double inverse_depth(int x, int y, bool has_wall = true) {
  if (std::hypot(x - 60.3, y - 44.6) < 25) return 0.6 + 0.001 * x + 0.002 * y;
  return has_wall ? 0.2 + 0.0006 * x - 0.0004 * y : 0;
}

Reading read_as(DepthKind kind, bool cuts = true) {
  Reading reading;
  reading.data = reading.display = {0, 0, kWidth, kHeight};
  reading.camera.width = kWidth, reading.camera.height = kHeight;
  reading.camera.fx = reading.camera.fy = 100;
  reading.camera.cx = 60, reading.camera.cy = 45;
  reading.depth_kind = kind;
  reading.depth_range.disparity_scale = 2;
  reading.depth_range.disparity_shift = 0.3;
  reading.cuts_ramps = cuts;
  return reading;
}

using Values = std::vector<float>;

Values values_of(DepthKind kind, bool has_wall = true) {
  Values values;
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) {
      const double u = inverse_depth(x, y, has_wall);
      values.push_back(kind == DepthKind::disparity ? float(2 * u + 0.3) : u > 0 ? float(1 / u) : kNoSurface);
    }
  return values;
}

/// The mean with a Gaussian of 1.5 px as weights.
Values blurred(const Values& values) {
  Values result;
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) {
      double sum = 0, weights = 0;
      for (int dy = std::max(-6, -y); dy <= std::min(6, kHeight - 1 - y); dy++)
        for (int dx = std::max(-6, -x); dx <= std::min(6, kWidth - 1 - x); dx++) {
          const double weight = std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5));
          sum += weight * values[std::size_t((y + dy) * kWidth + x + dx)];
          weights += weight;
        }
      result.push_back(float(sum / weights));
    }
  return result;
}

/// The pixels that are off by more than this part, without those at the picture's border.
int wrong(const Values& values, const Values& truth, double part = 0.02) {
  int count = 0;
  for (int y = 8; y < kHeight - 8; y++)
    for (int x = 8; x < kWidth - 8; x++) {
      const auto i = std::size_t(y * kWidth + x);
      count += !(std::abs(values[i] - truth[i]) <= part * truth[i]);
    }
  return count;
}

TEST(Ramps, become_the_surfaces_on_both_sides) {
  for (const DepthKind kind : {DepthKind::disparity, DepthKind::planar}) {
    const Values truth = values_of(kind);
    Values values = blurred(truth);
    EXPECT_GT(wrong(values, truth), 500);
    cut_ramps(read_as(kind), values);
    EXPECT_LT(wrong(values, truth), 16) << "pixels that the outline cuts in halves may be of either";
  }
}

TEST(Ramps, before_the_sky_become_surface_or_sky) {
  const Values truth = values_of(DepthKind::disparity, false);
  Values values = blurred(truth);
  EXPECT_GT(wrong(values, truth), 500);
  cut_ramps(read_as(DepthKind::disparity), values);
  EXPECT_LT(wrong(values, truth), 16);
}

/// A picture whose rows, or columns, are this profile between its ends.
Values striped(const Values& profile, bool is_across, bool is_mirrored) {
  Values values(std::size_t(kWidth * kHeight));
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) {
      int i = std::clamp((is_across ? x : y) - 40, 0, int(profile.size()) - 1);
      if (is_mirrored) i = int(profile.size()) - 1 - i;
      values[std::size_t(y * kWidth + x)] = profile[std::size_t(i)];
    }
  return values;
}

/// The profile after the cut of such a picture, which must be the same both ways.
Values cut_profile(DepthKind kind, const Values& profile) {
  Values result;
  for (const bool is_across : {true, false})
    for (const bool is_mirrored : {false, true}) {
      Values values = striped(profile, is_across, is_mirrored);
      cut_ramps(read_as(kind), values);
      Values found;
      for (std::size_t i = 0; i < profile.size(); i++)
        found.push_back(values[is_across ? 45 * kWidth + 40 + i : 45 + (40 + i) * kWidth]);
      if (is_mirrored) std::ranges::reverse(found);
      if (!result.empty())
        EXPECT_THAT(found, testing::Pointwise(testing::NanSensitiveFloatEq(), result)) << is_across << is_mirrored;
      result = found;
    }
  return result;
}

TEST(Ramps, of_every_contrast_and_width_are_cut_in_both_directions) {
  for (const float far : {8.f, 40.f, 100.f})
    for (int steps = 2; steps <= 7; steps++) {
      Values linear, smooth;
      for (int i = 0; i <= steps; i++) {
        const float part = float(i) / float(steps);
        linear.push_back(4 + (far - 4) * part);
        smooth.push_back(4 + (far - 4) * part * part * (3 - 2 * part));
      }
      for (const Values& profile : {linear, smooth})
        for (const float z : cut_profile(DepthKind::planar, profile))
          EXPECT_LT(std::min(std::abs(z - 4), std::abs(z - far)), 0.01) << steps << " steps to " << far;
    }
}

TEST(Ramps, before_a_sky_of_any_value_become_surface_or_sky) {
  const float inf = std::numeric_limits<float>::infinity(), none = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(cut_profile(DepthKind::planar, {5, 4, 3, 2, 1, 0}), Values({5, 5, 5, 0, 0, 0}));
  EXPECT_EQ(cut_profile(DepthKind::planar, {4, 5, 7, 20, inf}), Values({4, 4, 4, inf, inf}));
  EXPECT_EQ(cut_profile(DepthKind::planar, {4, 5, 7, 20, kNoSurface}), Values({4, 4, 4, kNoSurface, kNoSurface}));
  // disparity whose sky is 0, which is beyond its shift
  EXPECT_EQ(cut_profile(DepthKind::disparity, {1, 0.9f, 0.7f, 0.4f, 0.1f, 0}), Values({1, 1, 1, 0, 0, 0}));
  const Values unknown = cut_profile(DepthKind::planar, {4, 5, 7, 20, none});
  EXPECT_EQ(unknown[3], 20) << "nothing tells where that ramp ends";
}

TEST(Ramps, of_wires_keep_to_their_side_of_the_crest) {
  const Values wire = cut_profile(DepthKind::disparity, {0.5f, 0.6f, 1.2f, 1.9f, 2, 1.9f, 1.2f, 0.6f, 0.5f});
  EXPECT_NEAR(wire[4], 2, 0.05) << "the crest stays";
  EXPECT_EQ(wire[1], 0.5f);
}

TEST(Ramps, at_corners_become_surfaces_too) {
  const auto square = [](int x, int y) { return std::abs(x - 60) < 20 && std::abs(y - 45) < 20 ? 2.f : 0.6f; };
  Values truth;
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) truth.push_back(square(x, y));
  Values values = blurred(truth);
  cut_ramps(read_as(DepthKind::disparity), values);
  EXPECT_LT(wrong(values, truth), 16);
  int between = 0;
  for (const float value : values) between += std::min(std::abs(value - 2), std::abs(value - 0.6f)) > 0.05;
  EXPECT_EQ(between, 0);
}

TEST(Ramps, on_slanted_planes_follow_them_in_planar_depth) {
  Values truth;
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) truth.push_back(1 / (x < 60 ? 0.05f + 0.003f * float(y) : 1.f));
  Values values = blurred(truth);
  cut_ramps(read_as(DepthKind::planar), values);
  EXPECT_EQ(wrong(values, truth, 0.01), 0);
}

TEST(Ramps, are_kept_unasked_and_sharp_outlines_keep_every_bit) {
  for (const DepthKind kind : {DepthKind::disparity, DepthKind::planar}) {
    const Values sharp = values_of(kind), soft = blurred(sharp);
    Values values = sharp;
    cut_ramps(read_as(kind), values);
    EXPECT_EQ(values, sharp);
    values = soft;
    cut_ramps(read_as(kind, false), values);
    EXPECT_EQ(values, soft);
  }
}

TEST(Ramps, take_the_memory_that_is_said) {
#if defined(ALCOVE_SANITIZE_ADDRESS) || defined(ALCOVE_SANITIZE_THREAD)
  GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  const auto bytes_per_pixel = [] {
    constexpr int kSide = 3000;  // planes of as many bytes are never put where others were freed
    Reading reading = read_as(DepthKind::planar);
    reading.data = reading.display = {0, 0, kSide, kSide};
    Values depth(reading.data.pixels(), 4);
    for (std::size_t i = 0; i < depth.size(); i++) depth[i] += float(std::clamp<int>(int(i % 100), 46, 54));
    const std::uint64_t before = peak_memory_bytes();
    cut_ramps(reading, depth);
    return double(peak_memory_bytes() - before) / double(depth.size());
  };
  // In a process of its own, whose peak is of nothing else. The copy that settling looks at is not of the cut.
  const auto is_said = [&] { return std::abs(bytes_per_pixel() + sizeof(float) - double(kRampBytes)) < 1.5; };
  EXPECT_EXIT(std::_Exit(is_said() ? 0 : 1), testing::ExitedWithCode(0), "");
}

TEST(Ramps, of_positions_are_refused) {
  Values values(std::size_t(3 * kWidth * kHeight), 1);
  expect_error(ErrorKind::usage, {"--set ramps=cut", "--depth-channel"},
               [&] { cut_ramps(read_as(DepthKind::position), values); });
}

}  // namespace
}  // namespace alcove::ramps_test
