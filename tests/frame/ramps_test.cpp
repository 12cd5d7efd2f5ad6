// Depth that was blurred across outlines has surfaces of its own there; cut, its pixels lie on those of the scene.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/ramps.h"

#include <cmath>

#include "tests/support/expect_error.h"

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

TEST(Ramps, of_positions_are_refused) {
  Values values(std::size_t(3 * kWidth * kHeight), 1);
  expect_error(ErrorKind::usage, {"--set ramps=cut", "--depth-channel"},
               [&] { cut_ramps(read_as(DepthKind::position), values); });
}

}  // namespace
}  // namespace alcove::ramps_test
