// The denoisers: what they keep, what they never mix, and the response to a single pixel.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/chain/compute.h"
#include "core/formats/exr.h"
#include "core/frame/gbuffer.h"
#include "core/run/resume.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using test::denoised, test::difference, test::mirrored, test::place, test::same_bits;
using test::Plane, test::Rendering, test::Scene, test::Shot, test::unit, test::Vec3;

constexpr double kRadian = std::numbers::pi / 180;
const Vec3 kForward{1, 0, 0};

EstimatorSettings bilateral(int radius) {
  EstimatorSettings settings = test::plain_settings();
  settings.radius = 1;
  settings.denoise = Denoise::bilateral;
  settings.denoise_radius = radius;
  return settings;
}

EstimatorSettings by_kernel(std::vector<double> weights) {
  EstimatorSettings settings = bilateral(3);
  settings.denoise_kernel = std::move(weights);
  return settings;
}

EstimatorSettings by_depth(double sigma) {
  EstimatorSettings settings = bilateral(3);
  settings.denoise_depth_sigma = sigma;
  return settings;
}

EstimatorSettings box() {
  EstimatorSettings settings = bilateral(3);
  settings.denoise = Denoise::box;
  return settings;
}

std::vector<EstimatorSettings> all_denoisers() {
  return {bilateral(1),         bilateral(3),  bilateral(8),   by_kernel({0.227, 0.194, 0.121, 0.054, 0.016}),
          by_kernel({1, 0, 3}), by_depth(0.1), by_depth(1e-4), box()};
}

std::string name_of(const EstimatorSettings& s) {
  return std::string(s.denoise == Denoise::box ? "box" : "bilateral") + " radius " + std::to_string(s.denoise_radius) +
         " weights " + std::to_string(s.denoise_kernel.size()) + " depth sigma " +
         std::to_string(s.denoise_depth_sigma);
}

/// Noise over the surfaces of a frame, 1 on its sky.
std::vector<float> noise_over(const Rendering& rendering) {
  std::mt19937 random(7);
  std::vector<float> ao;
  for (const test::Hit& hit : rendering.hits) ao.push_back(hit.primitive < 0 ? 1.0f : float(random() % 4096) / 4095);
  return ao;
}

/// Two walls that face the camera, the second further away from pixel 40 on.
Rendering step(double nearer, double further, Vec3 normal = {-1, 0, 0}) {
  const Shot shot = Shot::perspective({}, kForward, 60, 80, 60);
  Rendering rendering = test::render({{Plane{.point = {nearer, 0, 0}, .normal = normal}}}, shot);
  const Rendering behind = test::render({{Plane{.point = {further, 0, 0}, .normal = normal}}}, shot);
  for (int y = 0; y < 60; y++)
    for (int x = 40; x < 80; x++)
      rendering.frame.depth[std::size_t(y * 80 + x)] = behind.frame.depth[std::size_t(y * 80 + x)];
  return rendering;
}

TEST(Denoise, keeps_what_is_constant_to_the_bit) {
  const Rendering room = test::furnished_room(101, 75);
  for (const EstimatorSettings& settings : all_denoisers()) {
    for (const float constant : {0.0f, 0.3f, 0.7317f, 1.0f}) {
      std::vector<float> ao;
      // the sky's 1 must not get in
      for (const test::Hit& hit : room.hits) ao.push_back(hit.primitive < 0 ? 1.0f : constant);
      EXPECT_TRUE(same_bits(denoised(room.frame, ao, settings), ao)) << name_of(settings) << " " << constant;
    }
  }
}

TEST(Denoise, leaves_the_sky_open) {
  const Rendering room = test::furnished_room(101, 75);
  for (const EstimatorSettings& settings : all_denoisers()) {
    const std::vector<float> ao = denoised(room.frame, noise_over(room), settings);
    for (std::size_t i = 0; i < ao.size(); i++)
      if (room.hits[i].primitive < 0) ASSERT_EQ(ao[i], 1.0f) << name_of(settings);
  }
}

TEST(Denoise, mixes_nothing_across_a_step) {
  std::vector<float> ao;
  for (int i = 0; i < 80 * 60; i++) ao.push_back(i % 80 < 40 ? 0.0f : 1.0f);
  for (const Rendering& rendering : {step(5, 5.5), step(5, 5.5, unit({-1, 0.7, 0.4})), step(5, 500)}) {
    for (const EstimatorSettings& settings : {bilateral(1), bilateral(3), bilateral(8), by_kernel({1, 1, 1}), box()})
      EXPECT_TRUE(same_bits(denoised(rendering.frame, ao, settings), ao)) << name_of(settings);
  }
  EXPECT_LE(difference(denoised(step(5, 5.5).frame, ao, by_depth(0.005)), ao).max, 1e-6);
}

TEST(Denoise, by_depth_sigma_weighs_a_step_by_its_exponential) {
  std::vector<float> ao;
  for (int i = 0; i < 80 * 60; i++) ao.push_back(i % 80 < 40 ? 0.0f : 1.0f);
  EstimatorSettings settings = by_kernel({2, 1});
  settings.denoise_depth_sigma = 0.1;
  const std::vector<float> result = denoised(step(5, 6).frame, ao, settings);
  const double other = std::exp(-1 / (0.1 * 5));  // against 2 of its own and 1 of its neighbour
  EXPECT_NEAR(result[30 * 80 + 39], other / (3 + other), 1e-5);
  EXPECT_NEAR(result[30 * 80 + 40], 3 / (3 + other), 1e-5);
}

TEST(Denoise, mixes_little_across_a_crease) {
  const Scene scene{
      {Plane{.point = {5, 0, 0}, .normal = unit({-1, 1, 0})}, Plane{.point = {5, 0, 0}, .normal = unit({-1, -1, 0})}}};
  const Rendering rendering = test::render(scene, Shot::perspective({}, kForward, 60, 80, 60));
  std::vector<float> ao;
  for (const test::Hit& hit : rendering.hits) ao.push_back(float(hit.primitive));
  const std::vector<float> result = denoised(rendering.frame, ao, bilateral(8));
  for (int y = 0; y < 60; y++)
    for (int x = 0; x < 80; x++)
      if (rendering.primitives_within(2, x, y) == 1)
        ASSERT_EQ(result[std::size_t(y * 80 + x)], ao[std::size_t(y * 80 + x)]) << x << " " << y;
}

// The response to a single pixel on a plane is the product of the weights: the filter is centred, keeps the mean, and
// sees no tilt.
TEST(Denoise, spreads_one_pixel_by_its_weights_at_every_tilt) {
  const std::pair<EstimatorSettings, std::vector<double>> cases[] = {
      {box(), {1, 1, 0.5}},
      {by_kernel({5, 0, 2, 1}), {5, 0, 2, 1}},
      {by_kernel({3, 3, 2, 2, 2, 1, 1, 1, 1}), {3, 3, 2, 2, 2, 1, 1, 1, 1}}};
  for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
    for (const double turn : {0.0, 37.0, 200.0}) {
      const double sine = std::sin(tilt * kRadian);
      const Vec3 normal{-std::cos(tilt * kRadian), sine * std::cos(turn * kRadian), sine * std::sin(turn * kRadian)};
      const Scene scene{{Plane{.point = {5, 0, 0}, .normal = normal}}};
      for (const Shot& shot :
           {Shot::perspective({}, kForward, 10, 41, 37), Shot::orthographic({}, kForward, 1, 41, 37)}) {
        const HostFrame frame = test::render(scene, shot).frame;
        std::vector<float> ao(41 * 37, 0.0f);
        ao[18 * 41 + 20] = 1;
        for (const auto& [settings, weights] : cases) {
          double sum = -weights[0];
          for (const double weight : weights) sum += 2 * weight;
          const auto weight_at = [&](int at) {
            return std::size_t(std::abs(at)) < weights.size() ? weights[std::size_t(std::abs(at))] / sum : 0;
          };
          const auto expected = [&](std::size_t i) {
            return weight_at(int(i % 41) - 20) * weight_at(int(i / 41) - 18);
          };
          const auto d = difference(denoised(frame, ao, settings), expected);
          EXPECT_LE(d.max, 1e-5) << name_of(settings) << " tilt " << tilt << " turn " << turn << " " << place(d, frame);
        }
      }
    }
  }
}

// At the border the weights are those of the pixels that there are.
TEST(Denoise, repeats_no_pixel_of_the_border) {
  const HostFrame frame =
      test::render({{Plane{.point = {5, 0, 0}, .normal = {-1, 0, 0}}}}, Shot::perspective({}, kForward, 60, 41, 37))
          .frame;
  std::vector<float> ao(41 * 37, 0.0f);
  ao.front() = ao.back() = 1;
  const std::vector<float> result = denoised(frame, ao, by_kernel({5, 3, 1}));
  for (const std::size_t last : {std::size_t(0), ao.size() - 1}) EXPECT_NEAR(result[last], 25.0 / 81, 1e-5);
  EXPECT_NEAR(result[1], 3.0 / 12 * 5 / 9, 1e-5);
}

TEST(Denoise, of_the_mirrored_frame_is_the_mirrored_result) {
  const Rendering room = test::furnished_room(101, 75);
  const std::vector<float> ao = noise_over(room);
  for (const EstimatorSettings& settings : all_denoisers()) {
    const std::vector<float> upright = denoised(room.frame, ao, settings);
    for (const bool left_right : {true, false}) {
      const std::vector<float> result =
          denoised(mirrored(room.frame, left_right), mirrored(ao, room.frame, left_right), settings);
      const auto d = difference(result, mirrored(upright, room.frame, left_right));
      EXPECT_LE(d.max, 1e-4) << name_of(settings) << place(d, room.frame);
    }
  }
}

TEST(Denoise, is_the_same_to_the_bit_in_units_of_any_power_of_two) {
  const Rendering room = test::furnished_room(101, 75);
  const std::vector<float> ao = noise_over(room);
  for (const EstimatorSettings& settings : all_denoisers()) {
    const std::vector<float> expected = denoised(room.frame, ao, settings);
    EXPECT_GT(difference(expected, ao).rmse, 0.01) << name_of(settings);
    for (const int exponent : {-20, 3, 24})
      EXPECT_TRUE(same_bits(denoised(test::scaled(room.frame, exponent), ao, settings), expected)) << name_of(settings);
  }
}

TEST(Denoise, takes_any_size_and_any_bits) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {3, 5}, {12, 12}, {13, 25}, {161, 91}}) {
    const HostFrame frame = test::random_bits(width, height, 3);
    const Scene scene{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.2, 0.3})}}};
    const Rendering plane = test::render(scene, Shot::perspective({}, kForward, 40, width, height));
    for (const EstimatorSettings& settings : all_denoisers()) {
      for (const float ao : denoised(frame, noise_over(plane), settings))
        ASSERT_TRUE(ao >= 0 && ao <= 1) << ao << " " << name_of(settings);
      std::vector<float> constant;
      for (const test::Hit& hit : plane.hits) constant.push_back(hit.primitive < 0 ? 1.0f : 0.4f);
      EXPECT_TRUE(same_bits(denoised(plane.frame, constant, settings), constant))
          << width << "x" << height << " " << name_of(settings);
    }
  }
}

TEST(Denoise, settings_are_in_the_digest) {
  const auto digest = [](const EstimatorSettings& estimator) {
    Settings settings;
    settings.estimator = estimator;
    return options_digest(settings);
  };
  const std::string plain = digest(bilateral(3));
  EXPECT_EQ(plain, digest(bilateral(3)));
  for (const EstimatorSettings& other : {bilateral(4), box(), by_depth(0.1), by_kernel({1, 1})})
    EXPECT_NE(plain, digest(other)) << name_of(other);
  EXPECT_NE(digest(by_kernel({1, 1})), digest(by_kernel({1, 0.5})));
}

// Measured 0.134 -> 0.101 and 0.102.
TEST(Denoise, brings_few_samples_nearer_to_ray_tracing) {
  const std::string base = ALCOVE_SOURCE_DIR "/examples/bench/colonnade";
  InputSettings input;
  input.input = base + ".gbuffer.exr";
  input.camera = base + ".camera.json";
  const HostFrame frame = read_host_frame(input, 0);
  const auto truth = read_exr_image(base + ".ao.a.exr").pixels;
  const auto error = [&](Denoise denoise) {
    EstimatorSettings settings = bilateral(3);
    settings.radius = 0.75;
    settings.slices = 1;
    settings.denoise = denoise;
    const std::vector<float> ao = compute_ao(test::recorder(), frame, settings).ao;
    double sum = 0;
    for (std::size_t i = 0; i < ao.size(); i++)
      sum += frame.depth[i] < 1e9f ? std::pow(double(ao[i]) - double(truth[i]), 2) : 0;
    return std::sqrt(sum / double(ao.size()));
  };
  const double plain = error(Denoise::none);
  RecordProperty("rmse", std::to_string(plain) + " " + std::to_string(error(Denoise::bilateral)) + " " +
                             std::to_string(error(Denoise::box)));
  EXPECT_LE(error(Denoise::bilateral), 0.8 * plain);
  EXPECT_LE(error(Denoise::box), 0.8 * plain);
}

}  // namespace
}  // namespace alcove
