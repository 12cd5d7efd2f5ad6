// The noise of the slices: a lattice that is the same however far away. What the filter leaves of it:
// clean_picture_test.
// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/base/shared.h"
#include "tests/support/chain.h"
#include "tests/support/site_frames.h"

namespace alcove::noise_test {
namespace {

using namespace test;

/// By what part of a turn, times 2^32, a number grows from pixel to pixel.
struct Lattice {
  std::uint32_t by_x, by_y;

  std::uint32_t at(int x, int y) const { return std::uint32_t(x) * by_x + std::uint32_t(y) * by_y; }
  double turns(int x, int y) const { return std::ldexp(double(at(x, y)), -32); }
  /// How far a step is from whole turns.
  double off_whole(int x, int y) const { return std::abs(turns(x, y) - std::round(turns(x, y))); }
};

constexpr Lattice kDirections{kNoiseXByX, kNoiseXByY}, kSteps{kNoiseYByX, kNoiseYByY};

/// A step in a wall, whose window lies so far from the display window's corner.
HostFrame step_at(int x, int y) {
  HostFrame frame = wall_at(x, y, 96, 72, {-1, 0, 0}, false);
  for (std::size_t i = 0; i < frame.depth.size(); i++)
    if (i % 96 > 20 && i % 96 < 50 && i / 96 > 15) frame.depth[i] -= 0.06f;
  return frame;
}

// Where both numbers have gone through whole turns the noise is the same again; in floats it would be off by 1/16 of a
// turn there, or more.
TEST(Noise, is_exact_a_million_pixels_away) {
  const EstimatorSettings settings = sampled(Estimator::gtao, 0.4, 2, 12);
  const std::vector<float> here = ao_of(step_at(0, 0), settings);
  const auto difference_at = [&](int x, int y) { return difference(ao_of(step_at(x, y), settings), here); };
  int found = 0;
  for (int y = 900001; y < 1000000 && found < 3; y += 997)
    for (int x = 800000; x < 1000000 && found < 3; x++) {
      if (kDirections.off_whole(x, y) > 1e-4 || kSteps.off_whole(x, y) > 1e-3) continue;
      found++;
      EXPECT_LT(difference_at(x, y).mean, 1e-4) << x << " " << y;
      EXPECT_GT(difference_at(x + 1, y).mean, 1e-3) << "or else there is no noise";
    }
  EXPECT_EQ(found, 3);
}

TEST(Noise, of_a_crop_far_away_is_that_of_the_whole) {
  EstimatorSettings settings;
  settings.radius = 0.2;  // 5 px
  const HostFrame whole = step_at(-1000003, 999999);
  const Window crop{whole.data.x + 5, whole.data.y + 3, 91, 69}, inner{crop.x + 27, crop.y + 27, 91 - 54, 69 - 54};
  const std::vector<float> ao = cropped(ao_of(crop_of(whole, crop), settings), crop, inner);
  EXPECT_TRUE(same_bits(ao, cropped(ao_of(whole, settings), whole.data, inner)));
  EXPECT_GT(std::ranges::count_if(ao, [](float value) { return value < 0.98; }), 10);
}

}  // namespace
}  // namespace alcove::noise_test
