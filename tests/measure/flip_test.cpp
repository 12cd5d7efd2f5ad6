// FLIP against its formulas worked out for plain colours, and against a second implementation.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/metrics.h"

#include "tests/support/picture_file.h"
#include "tests/support/test.h"

namespace alcove::flip_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

ColorPlanes planes_of(const ColorImage& image) { return {image[0], image[1], image[2]}; }

double mean(const Plane& map) { return std::accumulate(map.begin(), map.end(), 0.0) / double(map.size()); }

Plane formula_flip(const ColorImage& result, const ColorImage& reference) {
  return ldr_flip(kFormulaWidth, kFormulaHeight, planes_of(result), planes_of(reference));
}

/// The error of two plain colours, the same at every pixel.
double plain_flip(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  constexpr int kSize = 25;
  const auto plain = [](const std::array<float, 3>& color) {
    ColorImage image;
    for (std::size_t c = 0; c < 3; c++) image[c].assign(kSize * kSize, color[c]);
    return image;
  };
  const ColorImage first = plain(a), second = plain(b);
  const Plane map = ldr_flip(kSize, kSize, planes_of(first), planes_of(second));
  const auto [least, most] = std::ranges::minmax(map);
  EXPECT_NEAR(least, most, 1e-6) << "filters leave a plain colour as it is";
  return mean(map);
}

TEST(LdrFlip, plain_greys_follow_the_formula) {
  // The largest HyAB distance after the Hunt adjustment, green against blue: 203.30165,
  // from L*a*b* (87.74, -86.18, 83.18) and (32.30, 79.19, -107.86).
  const double most = std::pow(203.30165459, 0.7), knee = 0.4 * most;
  const auto lightness = [](double display) { return 116 * std::cbrt(std::pow((display + 0.055) / 1.055, 2.4)) - 16; };
  const double step = std::pow(lightness(0.6f) - lightness(0.5f), 0.7);
  EXPECT_NEAR(plain_flip({0.5f, 0.5f, 0.5f}, {0.6f, 0.6f, 0.6f}), 0.95 * step / knee, 1e-6);
  EXPECT_NEAR(plain_flip({0, 0, 0}, {1, 1, 1}), 0.95 + 0.05 * (std::pow(100, 0.7) - knee) / (most - knee), 1e-6);
}

TEST(LdrFlip, green_against_blue_is_the_largest_error) {
  EXPECT_NEAR(plain_flip({0, 1, 0}, {0, 0, 1}), 1, 1e-6);
  EXPECT_NEAR(plain_flip({1, 0, 0}, {0, 1, 0}), 0.986662275, 1e-6);
  EXPECT_NEAR(plain_flip({0, 0, 0}, {0, 0, 1}), 0.958329499, 1e-6);
}

TEST(LdrFlip, lies_between_0_and_1_whatever_comes_in) {
  ColorImage wild = noise_result();
  for (auto& plane : wild)
    for (auto& value : plane) value = 5 * value - 2;
  EXPECT_THAT(formula_flip(wild, noise_reference()), Each(AllOf(testing::Ge(0), testing::Le(1))));
}

TEST(LdrFlip, values_outside_of_0_and_1_are_clamped) {
  EXPECT_EQ(plain_flip({-3, 0, 0}, {0, 9, 0}), plain_flip({0, 0, 0}, {0, 1, 0}));
}

TEST(LdrFlip, of_equal_pictures_is_0_and_is_the_same_for_exchanged_and_turned_ones) {
  EXPECT_THAT(formula_flip(noise_result(), noise_result()), Each(0));
  EXPECT_EQ(formula_flip(noise_result(), noise_reference()), formula_flip(noise_reference(), noise_result()));
  const auto turned = [](ColorImage image) {
    for (auto& plane : image) std::ranges::reverse(plane);
    return image;
  };
  const Plane map = formula_flip(noise_result(), noise_reference());
  const Plane other = formula_flip(turned(noise_result()), turned(noise_reference()));
  for (std::size_t i = 0; i < map.size(); i++) ASSERT_NEAR(map[i], other[map.size() - 1 - i], 1e-5) << i;
}

// From an implementation of our own in NumPy and double precision, with whole 2-D kernels instead of separable ones.
TEST(LdrFlip, stored_values_of_a_second_implementation) {
  const Plane noise = formula_flip(noise_result(), noise_reference());
  EXPECT_NEAR(mean(noise), 0.323722805, 1e-6);
  EXPECT_NEAR(noise[0], 0.029864242, 1e-6);
  EXPECT_NEAR(noise[13 * kFormulaWidth + 20], 0.244680692, 1e-6);
  const ColorImage grey{ramp_plane(0, 1), ramp_plane(0, 1), ramp_plane(0, 1)},
      box{ramp_with_box(), ramp_with_box(), ramp_with_box()};
  EXPECT_NEAR(mean(formula_flip(box, grey)), 0.110418082, 1e-6);
  const Plane ramps = formula_flip({ramp_plane(0, 1), ramp_plane(5, 2), ramp_plane(9, 3)},
                                   {ramp_plane(4, 1), ramp_plane(5, 2), ramp_plane(0, 3)});
  EXPECT_NEAR(mean(ramps), 0.155553201, 1e-6);
  EXPECT_NEAR(ramps[13 * kFormulaWidth + 20], 0.139035488, 1e-6);
}

TEST(LdrFlip, a_picture_of_one_pixel_is_measured) {
  const Plane black{0}, white{1};
  EXPECT_NEAR(ldr_flip(1, 1, {black, black, black}, {white, white, white})[0], 0.967379762, 1e-6);
}

// HDR.

double curve(double x) {
  return (0.36 * 2.51 * x * x + 0.6 * 0.03 * x) / (0.36 * 2.43 * x * x + 0.6 * 0.59 * x + 0.14);
}

TEST(HdrFlip, exposures_run_from_the_brightest_to_the_median_just_below_white) {
  const Plane grey{0.5, 1, 1, 16, 0.25};
  const auto range = hdr_flip_exposures({grey, grey, grey});
  EXPECT_NEAR(curve(16 * std::exp2(range.start)), 0.85, 1e-9);
  EXPECT_NEAR(curve(1 * std::exp2(range.stop)), 0.85, 1e-9);
  EXPECT_EQ(range.count, 4);
}

TEST(HdrFlip, a_reference_of_one_value_has_two_exposures_and_a_black_one_is_measured) {
  const Plane one(9, 3.0f), black(9, 0.0f);
  EXPECT_EQ(hdr_flip_exposures({one, one, one}).count, 2);
  EXPECT_EQ(hdr_flip_exposures({black, black, black}).count, 2);
  for (const float error : hdr_flip(3, 3, {one, one, one}, {black, black, black})) EXPECT_GT(error, 0.9);
}

ColorImage bright(ColorImage image) {
  for (auto& plane : image)
    for (auto& value : plane) {
      value *= value;
      value *= value;
      value *= 100;
    }
  return image;
}

TEST(HdrFlip, stored_values_of_a_second_implementation) {
  const auto result = bright(noise_result()), reference = bright(noise_reference());
  const auto range = hdr_flip_exposures(planes_of(reference));
  EXPECT_EQ(range.count, 3);
  EXPECT_NEAR(range.start, -5.445521648, 1e-6);
  EXPECT_NEAR(range.stop, -2.530752331, 1e-6);
  const Plane map = hdr_flip(kFormulaWidth, kFormulaHeight, planes_of(result), planes_of(reference));
  EXPECT_NEAR(mean(map), 0.350697240, 1e-6);
  EXPECT_NEAR(map[13 * kFormulaWidth + 20], 0.220923568, 1e-6);
}

TEST(HdrFlip, of_equal_pictures_is_0_and_is_the_same_for_twice_the_light) {
  auto result = bright(noise_result()), reference = bright(noise_reference());
  EXPECT_THAT(hdr_flip(kFormulaWidth, kFormulaHeight, planes_of(result), planes_of(result)), Each(0));
  const Plane once = hdr_flip(kFormulaWidth, kFormulaHeight, planes_of(result), planes_of(reference));
  for (auto* image : {&result, &reference})
    for (auto& plane : *image)
      for (auto& value : plane) value *= 2;
  const Plane twice = hdr_flip(kFormulaWidth, kFormulaHeight, planes_of(result), planes_of(reference));
  for (std::size_t i = 0; i < once.size(); i++) ASSERT_NEAR(once[i], twice[i], 1e-5) << i;
}

}  // namespace
}  // namespace alcove::flip_test
