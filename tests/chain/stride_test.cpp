// Estimates at one pixel of 2, 4, 8 or 16, given to the others by the denoiser.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/estimator_facts.h"
#include "core/chain/compute.h"
#include "core/chain/filters.h"
#include "core/chain/sites.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"
#include "tests/support/single_pass.h"
#include "tests/support/sites_of.h"

namespace alcove {
namespace {

using namespace test;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

constexpr SiteRule kRules[] = {{2, false}, {4, false}, {8, false}, {16, false},
                               {2, true},  {4, true},  {8, true},  {16, true}};

std::string name_of(const testing::TestParamInfo<SiteRule>& info) {
  return (info.param.is_adaptive ? "adaptive_" : "uniform_") + std::to_string(info.param.spacing);
}

EstimatorSettings sparse_settings(double radius, const SiteRule& rule, int denoise_radius = 0) {
  EstimatorSettings settings;
  settings.radius = radius;
  settings.slices = 2;
  settings.steps = 12;
  settings.stride = rule.spacing;
  settings.density = rule.is_adaptive ? Density::adaptive : Density::uniform;
  settings.denoise = Denoise::bilateral;
  settings.denoise_radius = denoise_radius;
  EXPECT_EQ(spacing_of(settings), rule.spacing);
  EXPECT_EQ(is_adaptive(settings), rule.is_adaptive);
  return settings;
}

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

/// The part of a frame in that window of its own pixels.
HostFrame crop_of(const HostFrame& whole, const Window& window) {
  HostFrame crop = whole;
  crop.data = window;
  crop.depth = cropped(whole.depth, whole.data, window);
  crop.normal.clear();
  const std::size_t pixels = whole.data.pixels();
  for (std::size_t axis = 0; axis < 3; axis++) {
    const auto plane = cropped({whole.normal.data() + axis * pixels, pixels}, whole.data, window);
    crop.normal.insert(crop.normal.end(), plane.begin(), plane.end());
  }
  return crop;
}

HostFrame floor_of(int width, int height) {
  return render(Scene{{parallelogram({-50, -50, 0}, {100, 0, 0}, {0, 100, 0})}},
                Shot::perspective({0, -3, 2}, {0, 0, 0}, 50, width, height))
      .frame;
}

class Sparse : public testing::TestWithParam<SiteRule> {};
INSTANTIATE_TEST_SUITE_P(Estimate, Sparse, testing::ValuesIn(kRules), name_of);

TEST_P(Sparse, every_pixel_of_a_plane_is_open_at_any_size_and_filter) {
  for (const int radius : {0, 1, 2, 3, 8})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {2, 7}, {13, 1}, {31, 17}, {64, 40}})
      for (const float value : run(floor_of(width, height), sparse_settings(1, GetParam(), radius)))
        ASSERT_EQ(value, 1.0f) << width << " x " << height << ", radius " << radius;
}

// What the estimate leaves out is never read, whatever the memory held before.
TEST_P(Sparse, pixels_without_an_estimate_may_hold_anything) {
  const Rendering room = furnished_room(31, 17);
  const std::vector<float> expected = run(room.frame, sparse_settings(1, GetParam()));
  for (float& value : recorder().buffer("ao", expected.size() * sizeof(float), gpu::Use::device).as<float>())
    value = kNaN;
  EXPECT_TRUE(same_bits(run(room.frame, sparse_settings(1, GetParam())), expected));
}

/// What the filter makes of values at sites, with no number anywhere else.
std::vector<float> interpolated(const HostFrame& frame, const EstimatorSettings& settings, auto value_at) {
  const FrameInputs inputs = upload(recorder(), frame);
  upload(recorder(), inputs);
  const GBuffer gbuffer = reconstruct(recorder(), prepare(recorder(), inputs));
  const Sites chosen = sites(recorder(), gbuffer, site_rule_of(settings));
  const SiteMap map = map_of(recorder(), gbuffer, chosen);
  gpu::Buffer& values = recorder().buffer("values of a test", frame.data.pixels() * sizeof(float), gpu::Use::upload);
  for (int y = 0; y < frame.data.height; y++)
    for (int x = 0; x < frame.data.width; x++)
      values.as<float>()[std::size_t(y * frame.data.width + x)] = map.is_site(x, y) ? float(value_at(x, y)) : kNaN;
  recorder().upload(values);
  const gpu::Buffer& result = interpolate(recorder(), gbuffer, values, chosen, denoiser_of(settings));
  recorder().download(result);
  recorder().run();
  const auto planes = result.as<const float>();
  return {planes.begin(), planes.end()};
}

/// Half of what rows round to, of what is blocked.
constexpr double kRounding = 0.5 / 65535 + 1e-6;

// No pixel is left without a share of a site, on whatever surface.
TEST_P(Sparse, constant_ao_stays_constant_through_every_filter) {
  const Rendering room = furnished_room(93, 71);
  for (const int radius : {0, 1, 2, 3, 4, 5, 6, 7, 8}) {
    const EstimatorSettings settings = sparse_settings(1, GetParam(), radius);
    const auto values = interpolated(room.frame, settings, [](int, int) { return 0.37; });
    int wrong = 0;
    for (std::size_t i = 0; i < values.size(); i++)
      wrong += !(std::abs(values[i] - (room.hits[i].primitive < 0 ? 1 : 0.37)) <= kRounding);
    EXPECT_EQ(wrong, 0) << "pixels, radius " << radius;
  }
}

TEST_P(Sparse, constant_ao_stays_constant_through_every_kernel) {
  const Rendering room = furnished_room(93, 71);
  const std::vector<std::vector<double>> kernels = {{1, 0}, {1, 1}, {5, 0, 0, 1}, {1, 1, 1, 1, 1, 1, 1, 1, 1}};
  for (const auto& kernel : kernels) {
    EstimatorSettings settings = sparse_settings(1, GetParam());
    settings.denoise_kernel = kernel;
    const auto values = interpolated(room.frame, settings, [](int, int) { return 0.37; });
    int wrong = 0;
    for (std::size_t i = 0; i < values.size(); i++)
      wrong += !(std::abs(values[i] - (room.hits[i].primitive < 0 ? 1 : 0.37)) <= kRounding);
    EXPECT_EQ(wrong, 0) << "pixels, kernel " << testing::PrintToString(kernel);
  }
}

void expect_a_site_for_every_pixel(const HostFrame& frame, const SiteRule& rule, const std::string& what) {
  const auto values = interpolated(frame, sparse_settings(1, rule), [](int, int) { return 0.37; });
  int wrong = 0;
  for (std::size_t i = 0; i < values.size(); i++)
    wrong += !(std::abs(values[i] - (frame.depth[i] >= frame.sky ? 1 : 0.37)) <= kRounding);
  EXPECT_EQ(wrong, 0) << "pixels of " << values.size() << ", " << what << ", spacing " << rule.spacing;
}

// Thin and small things too.
TEST(Adaptive, leaves_no_pixel_of_any_scene_without_a_site) {
  RandomScenes scenes(18);
  for (int i = 0; i < 150; i++)
    expect_a_site_for_every_pixel(scenes.next(), {2 << i % 4, true}, "scene " + std::to_string(i));
}

// What the border cuts off a surface can be a single pixel, with nothing but sky beside it.
TEST(Adaptive, leaves_no_pixel_at_a_border_without_a_site) {
  for (const double turn : {0.0, 37.0, 77.0, 111.0, 200.0, 301.0}) {
    const double t = turn * std::numbers::pi / 180;
    const double sine = std::sin(85 * std::numbers::pi / 180);
    const Plane plane{.point = {5, 0, 0},
                      .normal = {-std::cos(85 * std::numbers::pi / 180), sine * std::cos(t), sine * std::sin(t)}};
    for (const double fov : {60.0, 110.0})
      for (const int spacing : {2, 4, 8, 16})
        expect_a_site_for_every_pixel(render({{plane}}, Shot::perspective({}, {1, 0, 0}, fov, 64, 48)).frame,
                                      {spacing, true}, "plane turned by " + std::to_string(turn));
  }
}

// A mean alone would bend it at the border, by several pixels of its rise.
TEST_P(Sparse, a_slope_of_the_ao_stays_a_slope_up_to_the_border) {
  const Shot shot = Shot::orthographic({0, 0, 3}, {0, 1e-3, 0}, 4, 64, 48);
  const HostFrame frame = render(Scene{{Plane{{0, 0, 0}, {0, 0, 1}}}}, shot).frame;
  constexpr double kRise = 0.01;  // per pixel
  const auto slope = [](int x, int y) { return 0.1 + kRise * (x + 0.5 * y); };
  const auto values = interpolated(frame, sparse_settings(1, GetParam()), slope);
  double worst = 0;
  for (int y = 0; y < 48; y++)
    for (int x = 0; x < 64; x++) worst = std::max(worst, std::abs(values[std::size_t(y * 64 + x)] - slope(x, y)));
  EXPECT_LT(worst, 2.5 * kRise) << "the rise of two pixels and a half";
}

// Nothing is left without an estimate, be it alone on its surface or beside the sky.
TEST_P(Sparse, is_as_near_to_the_dense_estimate_as_noise_allows) {
  const Rendering room = furnished_room(192, 144);
  EstimatorSettings many = sparse_settings(0.5, GetParam(), 1);
  many.stride = 1;
  many.slices = 16;
  const std::vector<float> truth = run(room.frame, many), sparse = run(room.frame, sparse_settings(0.5, GetParam()));
  double sum = 0, flat = 0;
  for (std::size_t i = 0; i < sparse.size(); i++) {
    ASSERT_GE(sparse[i], 0.0f);
    ASSERT_LE(sparse[i], 1.0f);
    if (room.hits[i].primitive < 0) ASSERT_EQ(sparse[i], 1.0f);
    sum += (double(sparse[i]) - truth[i]) * (double(sparse[i]) - truth[i]);
    flat += (1.0 - truth[i]) * (1.0 - truth[i]);
  }
  EXPECT_LT(std::sqrt(sum / double(sparse.size())), 0.04);
  EXPECT_GT(std::sqrt(flat / double(sparse.size())), 0.1) << "or else there is nothing to find";
}

// Sites are counted from the display window, and no sum depends on where the image begins.
TEST_P(Sparse, crop_is_the_whole_frame_there) {
  const Rendering whole = furnished_room(192, 144);
  const EstimatorSettings settings = sparse_settings(0.1, GetParam());
  const std::vector<float> expected = run(whole.frame, settings);
  for (const Window& window : {Window{37, 21, 130, 110}, {36, 24, 132, 108}, {32, 16, 136, 112}, {35, 22, 133, 111}}) {
    const std::vector<float> ao = run(crop_of(whole.frame, window), settings);
    const int margin = 36;
    int other = 0;
    int darkened = 0;
    for (int y = margin; y < window.height - margin; y++)
      for (int x = margin; x < window.width - margin; x++) {
        const float value = ao[std::size_t(y) * std::size_t(window.width) + std::size_t(x)];
        other += value != expected[std::size_t(y + window.y) * 192 + std::size_t(x + window.x)];
        darkened += value < 0.98;
      }
    EXPECT_EQ(other, 0) << "pixels, of the crop at " << window.x << " " << window.y;
    EXPECT_GT(darkened, 20);
  }
}

SiteMap sites_of(const HostFrame& frame, const SiteRule& rule) {
  const FrameInputs inputs = upload(recorder(), frame);
  upload(recorder(), inputs);
  const GBuffer gbuffer = reconstruct(recorder(), prepare(recorder(), inputs));
  return map_of(recorder(), gbuffer, sites(recorder(), gbuffer, rule));
}

TEST_P(Sparse, sites_are_the_surfaces_on_the_lattice_and_where_it_is_uniform_no_others) {
  const Rendering room = furnished_room(93, 71);
  for (const auto& [left, top] : {std::pair{0, 0}, {1, 2}, {3, 1}, {6, 7}}) {
    HostFrame frame = room.frame;
    frame.data.x = frame.display.x + left;
    frame.data.y = frame.display.y + top;
    const SiteMap map = sites_of(frame, GetParam());
    int on_lattice = 0;
    int others = 0;
    for (int y = 0; y < 71; y++)
      for (int x = 0; x < 93; x++) {
        const bool is_sky = room.at(x, y).primitive < 0;
        const bool expected = !is_sky && is_on_lattice(x + left, y + top, GetParam().spacing);
        if (is_sky || expected) ASSERT_EQ(map.is_site(x, y), expected) << x << " " << y << " at " << left << " " << top;
        on_lattice += expected;
        others += map.is_site(x, y) && !expected;
      }
    EXPECT_GT(on_lattice, 93 * 71 / 2 / GetParam().spacing);
    if (!GetParam().is_adaptive) EXPECT_EQ(others, 0);
    if (GetParam().is_adaptive && GetParam().spacing > 2) EXPECT_GT(others, 0) << "edges need more";
  }
}

// In the lower right corner the lattice has no pixel on three sides.
TEST(Sites, of_a_plane_are_no_more_than_the_lattice_but_at_its_own_edges) {
  for (const int spacing : {2, 4, 8, 16}) {
    const SiteMap map = sites_of(floor_of(96, 80), {spacing, true});
    for (int y = 0; y < 80; y++)
      for (int x = 0; x < 96; x++)
        ASSERT_EQ(map.is_site(x, y),
                  is_on_lattice(x, y, spacing) || (x > 92 && y > 76 && spacing > 2 && map.is_site(x, y)))
            << x << " " << y << " spacing " << spacing;
  }
}

// Tiles and regions are computed with so many pixels around them.
TEST(Sites, depend_on_nothing_that_is_more_than_13_pixels_away) {
  RandomScenes scenes(18);
  int compared = 0;
  int other = 0;
  for (int i = 0; i < 60; i++) {
    const HostFrame whole = scenes.next(2);
    if (whole.normal.empty() || whole.data.width < 60 || whole.data.height < 60) continue;
    const int left = scenes.whole(0, 20);
    const int top = scenes.whole(0, 20);
    const Window window{left, top, whole.data.width - left - scenes.whole(0, 8), whole.data.height - top - 3};
    const SiteMap expected = sites_of(whole, {16, true});
    const SiteMap map = sites_of(crop_of(whole, window), {16, true});
    for (int y = 0; y < window.height; y++)
      for (int x = 0; x < window.width; x++) {
        const int away = std::min({x, y, window.width - 1 - x, window.height - 1 - y});
        const bool is_same = map.is_site(x, y) == expected.is_site(x + left, y + top);
        if (away >= 13) ASSERT_TRUE(is_same) << x << " " << y << " of scene " << i;
        compared += away >= 13;
        other += !is_same;
      }
  }
  EXPECT_GT(compared, 10000);
  EXPECT_GT(other, 0) << "or else no border was near anything";
}

TEST(Stride, left_open_is_sparse_only_where_the_denoiser_shares) {
  EstimatorSettings settings;
  settings.density = Density::uniform;
  settings.slices = 2;
  EXPECT_EQ(spacing_of(settings), 4);
  settings.slices = 3;
  EXPECT_EQ(spacing_of(settings), 1);
  settings.slices = 1;
  settings.denoise = Denoise::none;
  EXPECT_EQ(spacing_of(settings), 1);
  settings.denoise = Denoise::box;
  EXPECT_EQ(spacing_of(settings), 1);
  settings.denoise = Denoise::bilateral;
  settings.estimator = Estimator::hbao;
  EXPECT_EQ(spacing_of(settings), 1);
  settings.estimator = Estimator::bitmask;
  EXPECT_EQ(spacing_of(settings), 1);
  settings.estimator = Estimator::gtao;
  settings.resolution = Resolution::half;
  EXPECT_EQ(spacing_of(settings), 1);
  settings.stride = 2;
  EXPECT_EQ(spacing_of(settings), 2);
}

TEST(Stride, left_open_is_16_for_an_adaptive_density_of_few_slices_and_2_of_many) {
  for (const int slices : {1, 3, 4, 5, 16})
    for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask, Estimator::hbao, Estimator::crytek}) {
      EstimatorSettings settings;
      ASSERT_EQ(settings.density, Density::adaptive);
      settings.estimator = estimator;
      settings.slices = slices;
      const bool is_sliced = searches_slices(settings);
      EXPECT_EQ(spacing_of(settings), is_sliced ? (slices < 5 ? 16 : 2) : 1) << int(estimator) << " " << slices;
      EXPECT_EQ(is_adaptive(settings), is_sliced) << int(estimator);
      settings.denoise = Denoise::none;
      EXPECT_EQ(spacing_of(settings), 1) << int(estimator);
      EXPECT_FALSE(is_adaptive(settings)) << int(estimator);
      settings.denoise = Denoise::bilateral;
      settings.resolution = Resolution::half;
      EXPECT_EQ(spacing_of(settings), 1) << int(estimator);
    }
}

TEST(Stride, of_an_exact_search_is_1) {
  for (const bool by_error : {false, true}) {
    EstimatorSettings settings;
    (by_error ? settings.tolerance : settings.power) = by_error ? 0.05 : 1;
    settings.search = by_error ? SliceSearch::steps : SliceSearch::exact;
    settings.stride = 8;
    EXPECT_EQ(spacing_of(settings), 1);
    EXPECT_FALSE(is_adaptive(settings));
  }
}

TEST(Stride, of_1_is_never_adaptive_and_a_uniform_density_neither) {
  EstimatorSettings settings;
  settings.stride = 1;
  EXPECT_FALSE(is_adaptive(settings));
  for (const int stride : {2, 4, 8, 16}) {
    settings.stride = stride;
    settings.density = Density::adaptive;
    EXPECT_TRUE(is_adaptive(settings));
    settings.density = Density::uniform;
    EXPECT_FALSE(is_adaptive(settings));
    EXPECT_EQ(spacing_of(settings), stride);
  }
}

TEST(DenoiseRadius, left_open_is_wide_where_pixels_share_estimates) {
  EstimatorSettings settings;
  EXPECT_EQ(denoise_radius_of(settings), 8);
  settings.stride = 2;
  EXPECT_EQ(denoise_radius_of(settings), 8);
  settings.stride = 1;
  EXPECT_EQ(denoise_radius_of(settings), 4);
  for (const int radius : {1, 5, 8}) {
    settings.denoise_radius = radius;
    settings.stride = 16;
    EXPECT_EQ(denoise_radius_of(settings), radius);
    EXPECT_EQ(denoiser_of(settings).weights.size(), std::size_t(std::max(radius, 3)) + 1) << "reaches all sites";
    settings.density = Density::uniform;
    EXPECT_EQ(denoiser_of(settings).weights.size(), 9);
    settings.density = Density::adaptive;
    settings.stride = 1;
    EXPECT_EQ(denoise_radius_of(settings), radius);
    EXPECT_EQ(denoiser_of(settings).weights.size(), std::size_t(radius) + 1);
  }
}

}  // namespace
}  // namespace alcove
