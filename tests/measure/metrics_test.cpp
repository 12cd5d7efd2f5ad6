// Metrics against values worked out by hand, against scikit-image, and by their symmetries.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/metrics.h"

#include "core/base/error.h"
#include "tests/support/picture_file.h"
#include "tests/support/test.h"

namespace alcove::metrics_test {
namespace {

using namespace test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
using Plane = std::vector<float>;
using Bytes = std::vector<std::uint8_t>;

// Sums.

TEST(PlaneErrors, four_values_by_hand) {
  const auto e = compare_planes(Plane{1, 0.5, 0.25, 0}, Plane{0.5, 0.5, 0.5, 0.5});  // errors .5, 0, -.25, -.5
  EXPECT_EQ(e.count, 4);
  EXPECT_EQ(e.excluded, 0);
  EXPECT_DOUBLE_EQ(e.rmse, std::sqrt((0.25 + 0 + 0.0625 + 0.25) / 4));
  EXPECT_DOUBLE_EQ(e.mae, 1.25 / 4);
  EXPECT_DOUBLE_EQ(e.bias, -0.25 / 4);
  EXPECT_DOUBLE_EQ(e.max, 0.5);
}

TEST(PlaneErrors, percentiles_lie_between_the_nearest_ranks) {
  Plane result(101);
  // sizes 0 .. 100 in some order
  for (int i = 0; i <= 100; i++) result[std::size_t((i * 37) % 101)] = float(i % 2 ? -i : i);
  const auto e = compare_planes(result, Plane(101));
  EXPECT_DOUBLE_EQ(e.p95, 95);
  EXPECT_DOUBLE_EQ(e.p99, 99);
  const auto two = compare_planes(Plane{1, 3}, Plane{0, 0});
  EXPECT_DOUBLE_EQ(two.p95, 1 + 0.95 * 2);
  EXPECT_DOUBLE_EQ(compare_planes(Plane{3}, Plane{1}).p99, 2);
}

TEST(PlaneErrors, exchanged_planes_change_the_sign_of_the_bias_only) {
  const auto a = formula_plane(1, 3, 1, 256), b = formula_plane(2, 1, 3, 200);
  const auto ab = compare_planes(a, b), ba = compare_planes(b, a);
  EXPECT_EQ(ab.rmse, ba.rmse);
  EXPECT_EQ(ab.mae, ba.mae);
  EXPECT_EQ(ab.max, ba.max);
  EXPECT_EQ(ab.p95, ba.p95);
  EXPECT_EQ(ab.bias, -ba.bias);
}

TEST(PlaneErrors, nan_and_infinity_in_either_are_left_out_and_counted) {
  const auto e = compare_planes(Plane{1, kNan, 0, kInf, 7}, Plane{0, 0, kNan, 0, 0}, Bytes{1, 1, 1, 1, 0});
  EXPECT_EQ(e.count, 1);
  EXPECT_EQ(e.excluded, 3);
  EXPECT_EQ(e.max, 1);
  EXPECT_EQ(compare_planes(Plane{kInf, 1}, Plane{kInf, 1}).excluded, 1);
}

TEST(PlaneErrors, one_mask_holds_for_each_of_several_planes) {
  const auto e = compare_planes(Plane{1, 9, 2, 9}, Plane{0, 0, 0, 0}, Bytes{1, 0});
  EXPECT_EQ(e.count, 2);
  EXPECT_DOUBLE_EQ(e.mae, 1.5);
}

TEST(PlaneErrors, nothing_to_compare_is_an_error) {
  EXPECT_THAT(error_of(ErrorKind::input,
                       [] {
                         compare_planes(Plane{kNan, kNan}, Plane{0, 0});
                       }),
              HasSubstr("2 are NaN"));
  EXPECT_THAT(error_of(ErrorKind::input,
                       [] {
                         compare_planes(Plane{1, 1}, Plane{0, 0}, Bytes{0, 0});
                       }),
              HasSubstr("no value to compare"));
  EXPECT_THAT(error_of(ErrorKind::input, [] { compare_planes(Plane{}, Plane{}); }), HasSubstr("no value to compare"));
}

TEST(UnbiasedRmse, independent_noise_of_two_references_cancels) {
  Plane result, a, b;
  for (int i = 0; i < 64; i++) {  // three patterns that are orthogonal over the 64 values: error .125, noise .25 and .5
    result.push_back(0.5f + (i & 1 ? 0.125f : -0.125f));
    a.push_back(0.5f + (i & 2 ? 0.25f : -0.25f));
    b.push_back(0.5f + (i & 4 ? 0.5f : -0.5f));
  }
  EXPECT_DOUBLE_EQ(compare_planes(result, a, {}, b).rmse, 0.125);
  EXPECT_GT(compare_planes(result, a).rmse, 0.27);
  EXPECT_DOUBLE_EQ(compare_planes(result, a, {}, b).mae,
                   compare_planes(result, Comparable{{}, a, b, {}}.mean_reference()).mae);
}

TEST(UnbiasedRmse, a_negative_mean_is_no_error) {
  EXPECT_EQ(compare_planes(Plane{0.5}, Plane{0}, {}, Plane{1}).rmse, 0);
}

TEST(Psnr, known_values) {
  EXPECT_DOUBLE_EQ(psnr(0.1), 20);
  EXPECT_DOUBLE_EQ(psnr(0.1, 10), 40);
  EXPECT_EQ(psnr(0), std::numeric_limits<double>::infinity());
}

// What looks at neighbourhoods.

TEST(MakeComparable, left_out_pixels_are_finite_and_equal) {
  const auto c = make_comparable("a against b", 4, Plane{1, kNan, 3, 4}, Plane{2, 3, kInf, 5}, {}, Bytes{0, 1, 1, 1});
  EXPECT_EQ(c.mask, (Bytes{0, 0, 0, 1}));
  EXPECT_EQ(c.result, (Plane{2, 3, 0, 4}));
  EXPECT_EQ(c.reference, (Plane{2, 3, 0, 5}));
  EXPECT_EQ(c.count, 1);
  EXPECT_EQ(c.excluded, 2);
  EXPECT_EQ(c.masked, 1);
}

TEST(MakeComparable, a_nan_in_one_plane_leaves_the_pixel_out_of_all) {
  const auto c = make_comparable("", 2, Plane{1, 2, kNan, 4}, Plane{1, 2, 3, 4}, Plane{1, 2, 3, 4}, {});
  EXPECT_EQ(c.mask, (Bytes{0, 1}));
  EXPECT_EQ(c.excluded, 1);
}

TEST(MakeComparable, no_pixel_left_is_an_error_that_says_why) {
  EXPECT_THAT(error_of(ErrorKind::input,
                       [] {
                         make_comparable("a against b", 2, Plane{kNan, 1}, Plane{0, 0}, {}, Bytes{1, 0});
                       }),
              AllOf(HasSubstr("a against b"), HasSubstr("1 are left out by the mask and 1 are NaN")));
}

double formula_ssim(const Plane& a, const Plane& b, Mask mask = {}, double peak = 1) {
  return ssim(kFormulaWidth, kFormulaHeight, a, b, mask, peak).value();
}

TEST(Ssim, stored_values_of_scikit_image_0_19_3) {
  EXPECT_NEAR(formula_ssim(formula_plane(1, 3, 2, 256), formula_plane(1, 3, 1, 256)), -0.015912049604, 1e-11);
  EXPECT_NEAR(formula_ssim(ramp_with_box(), ramp_plane(0, 1)), 0.707282647151, 1e-11);
  EXPECT_NEAR(formula_ssim(ramp_with_box(), ramp_plane(0, 1), {}, 2), 0.751035250255, 1e-11);
}

TEST(Ssim, equal_planes_have_1_and_exchanged_planes_the_same) {
  const auto a = formula_plane(1, 3, 1, 256), b = formula_plane(2, 1, 3, 200);
  EXPECT_DOUBLE_EQ(formula_ssim(a, a), 1);
  EXPECT_DOUBLE_EQ(formula_ssim(a, b), formula_ssim(b, a));
}

TEST(Ssim, of_two_constants_is_the_luminance_term) {
  const double expected = (2 * 0.25 * 0.5 + 1e-4) / (0.25 * 0.25 + 0.5 * 0.5 + 1e-4);
  EXPECT_NEAR(*ssim(20, 20, Plane(400, 0.25f), Plane(400, 0.5f)), expected, 1e-12);
}

TEST(Ssim, needs_a_pixel_5_from_all_borders) {
  EXPECT_FALSE(ssim(10, 30, Plane(300), Plane(300)));
  EXPECT_TRUE(ssim(11, 11, Plane(121), Plane(121)));
  Bytes border(121, 1);
  border[60] = 0;  // the one pixel inside
  EXPECT_FALSE(ssim(11, 11, Plane(121), Plane(121), border));
}

TEST(DarknessBands, values_go_where_the_reference_is) {
  const auto bands = darkness_bands(Plane{0, 0.5, 0.5, 1, 2, -1}, Plane{0.25, 0.25, 0.75, 0.5, 1.5, -0.5});
  const auto expect = [&](std::size_t i, double from, std::size_t count, double rmse, double bias) {
    EXPECT_DOUBLE_EQ(bands[i].from, from);
    EXPECT_EQ(bands[i].errors.count, count) << i;
    EXPECT_DOUBLE_EQ(bands[i].errors.rmse, rmse) << i;
    EXPECT_DOUBLE_EQ(bands[i].errors.bias, bias) << i;
  };
  expect(0, 0, 1, 0.5, -0.5);   // -.5: below all bands
  expect(1, 0.25, 2, 0.25, 0);  // -.25, +.25
  expect(2, 0.5, 1, 0.5, 0.5);
  expect(3, 0.75, 2, std::sqrt((0.0625 + 0.25) / 2), 0.125);  // -.25, +.5: above all bands
}

TEST(DepthEdges, reach_two_pixels_to_each_side_of_a_step) {
  const Plane row{1, 1, 1, 1, 1, 1.2f, 1.2f, 1.2f, 1.2f, 1.2f};
  EXPECT_EQ(depth_edges(10, 1, row, 1e9), (Bytes{0, 0, 1, 1, 1, 1, 1, 1, 0, 0}));
  EXPECT_EQ(depth_edges(1, 10, row, 1e9), (Bytes{0, 0, 1, 1, 1, 1, 1, 1, 0, 0}));
}

TEST(DepthEdges, a_slope_is_none_and_the_sky_is_one) {
  EXPECT_THAT(depth_edges(5, 1, Plane{1, 1.09f, 1.18f, 1.28f, 1.38f}, 1e9), Each(0));
  EXPECT_THAT(depth_edges(3, 1, Plane{1, kInf, kInf}, 1e9), Each(1));
  EXPECT_THAT(depth_edges(5, 1, Plane{kInf, 1e10f, 0, kNan, -1}, 1e9), Each(0)) << "all of it is sky";
  EXPECT_EQ(surfaces(Plane{kInf, 1e10f, 0, kNan, -1, 1}, 1e9), (Bytes{0, 0, 0, 0, 0, 1}));
}

TEST(EdgeErrors, are_told_apart) {
  const auto e = edge_errors(Bytes{1, 0, 0, 0}, Plane{2, 1, 3, 9}, Plane{0, 0, 0, 0}, Bytes{1, 1, 1, 0});
  EXPECT_EQ(e.at.count, 1);
  EXPECT_DOUBLE_EQ(e.at.bias, 2);
  EXPECT_EQ(e.away.count, 2);
  EXPECT_DOUBLE_EQ(e.away.rmse, std::sqrt(5.0));
}

// Flicker.

ErrorFrame frame_of(int width, int height, Plane error) {
  ErrorFrame frame{width, height, std::move(error), {}, {}, {}, {}, {}};
  frame.mask.assign(frame.error.size(), 1);
  return frame;
}

double flicker_of(const ErrorFrame& previous, const ErrorFrame& here) {
  Flicker flicker;
  flicker.add(previous, here);
  return flicker.rms();
}

TEST(Flicker, is_the_rms_of_the_change) {
  EXPECT_EQ(flicker_of(frame_of(2, 2, {1, 2, 3, 4}), frame_of(2, 2, {1, 2, 3, 4})), 0);
  EXPECT_DOUBLE_EQ(flicker_of(frame_of(2, 1, {0, 0}), frame_of(2, 1, {3, -4})), std::sqrt(12.5));
}

TEST(Flicker, an_error_that_moves_with_its_surface_is_none) {
  auto previous = frame_of(3, 3, {1, 2, 3, 4, 5, 6, 7, 8, 9}), here = frame_of(3, 3, {5, 6, 99, 8, 9, 99, 99, 99, 99});
  here.motion_x.assign(9, 1.2f);   // everything was one pixel to the right,
  here.motion_y.assign(9, -0.9f);  // and one below: y is up
  Flicker flicker;
  flicker.add(previous, here);
  EXPECT_EQ(flicker.count(), 4) << "the others were outside";
  EXPECT_EQ(flicker.rms(), 0);
}

TEST(Flicker, masked_and_uncovered_surfaces_are_left_out) {
  auto previous = frame_of(4, 1, {0, 0, 0, 0}), here = frame_of(4, 1, {1, 9, 9, 9});
  previous.mask = {1, 0, 1, 1};
  here.mask = {1, 1, 0, 1};
  previous.depth = {1, 1, 1, 1};
  here.depth = {1.05f, 1, 1, 2};
  Flicker flicker;
  flicker.add(previous, here);
  EXPECT_EQ(flicker.count(), 1);
  EXPECT_DOUBLE_EQ(flicker.rms(), 1);
  here.motion_x = here.motion_y = Plane(4, kNan);
  EXPECT_EQ(flicker_of(previous, here), 0);
}

TEST(Flicker, noise_of_two_references_cancels) {
  auto previous = frame_of(64, 1, Plane(64)), here = frame_of(64, 1, Plane(64));
  previous.error_b = here.error_b = Plane(64);
  for (std::size_t i = 0; i < 64; i++) {
    here.error[i] = 0.125f + (i & 1 ? 0.5f : -0.5f);
    here.error_b[i] = 0.125f + (i & 2 ? 0.5f : -0.5f);
  }
  EXPECT_DOUBLE_EQ(flicker_of(previous, here), 0.125);
}

}  // namespace
}  // namespace alcove::metrics_test
