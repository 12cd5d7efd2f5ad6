// The denoisers: what they keep, what they never mix, and the response to a single pixel.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/site_frames.h"

namespace alcove::denoise_test {
namespace {

using namespace test;

EstimatorSettings bilateral(int radius) {
  EstimatorSettings settings = plain_settings();
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

/// Noise over the surfaces of a frame, 1 on its sky.
std::vector<float> noise_over(const Rendering& rendering) {
  std::mt19937 random(7);
  std::vector<float> ao;
  for (const Hit& hit : rendering.hits) ao.push_back(hit.primitive < 0 ? 1.0f : float(random() % 4096) / 4095);
  return ao;
}

/// Two walls that face the camera, the second further away from pixel 40 on.
HostFrame step(double nearer, double further, Vec3 normal = {-1, 0, 0}) {
  HostFrame frame = render({{Plane{.point = {nearer, 0, 0}, .normal = normal}}}, along_x(60, 80, 60)).frame;
  const HostFrame behind = render({{Plane{.point = {further, 0, 0}, .normal = normal}}}, along_x(60, 80, 60)).frame;
  for (std::size_t i = 0; i < frame.depth.size(); i++)
    if (i % 80 >= 40) frame.depth[i] = behind.depth[i];
  return frame;
}

/// 0 on the nearer wall, 1 on the other.
std::vector<float> step_of_ao() {
  std::vector<float> ao;
  for (int i = 0; i < 80 * 60; i++) ao.push_back(i % 80 < 40 ? 0.0f : 1.0f);
  return ao;
}

TEST(Denoise, keeps_what_is_constant_to_the_bit_at_any_size) {
  for (const auto& [width, height] :
       {std::pair{101, 75}, {1, 1}, {1, 40}, {40, 1}, {3, 5}, {12, 12}, {13, 25}, {161, 91}}) {
    const Rendering room = furnished_room(width, height);
    for (const EstimatorSettings& settings : all_denoisers())
      for (const float constant : {0.0f, 0.3f, 0.7317f, 1.0f}) {
        std::vector<float> ao;
        // the sky's 1 must not get in
        for (const Hit& hit : room.hits) ao.push_back(hit.primitive < 0 ? 1.0f : constant);
        EXPECT_TRUE(same_bits(denoised(room.frame, ao, settings), ao))
            << name_of(settings) << " " << constant << ", " << width << " x " << height;
      }
  }
}

TEST(Denoise, mixes_nothing_across_a_step) {
  const std::vector<float> ao = step_of_ao();
  for (const HostFrame& frame : {step(5, 5.5), step(5, 5.5, unit({-1, 0.7, 0.4})), step(5, 500)})
    for (const EstimatorSettings& settings : {bilateral(1), bilateral(3), bilateral(8), by_kernel({1, 1, 1}), box()})
      EXPECT_TRUE(same_bits(denoised(frame, ao, settings), ao)) << name_of(settings);
  EXPECT_LE(difference(denoised(step(5, 5.5), ao, by_depth(0.005)), ao).max, 1e-6);
}

TEST(Denoise, by_depth_sigma_weighs_a_step_by_its_exponential) {
  EstimatorSettings settings = by_kernel({2, 1});
  settings.denoise_depth_sigma = 0.1;
  const std::vector<float> result = denoised(step(5, 6), step_of_ao(), settings);
  const double other = std::exp(-1 / (0.1 * 5));  // against 2 of its own and 1 of its neighbour
  EXPECT_NEAR(result[30 * 80 + 39], other / (3 + other), 1e-5);
  EXPECT_NEAR(result[30 * 80 + 40], 3 / (3 + other), 1e-5);
}

TEST(Denoise, mixes_nothing_across_a_crease) {
  const Crease crease;
  EXPECT_LT(difference(denoised(crease.rendering.frame, crease.sides(), bilateral(8)), crease.sides()).max, 1e-3);
}

// The response to a single pixel on a plane is the product of the weights: the filter is centred, keeps the mean, and
// sees no tilt.
TEST(Denoise, spreads_one_pixel_by_its_weights_at_every_tilt) {
  const std::pair<EstimatorSettings, std::vector<double>> cases[] = {
      {box(), {1, 1, 0.5}},
      {by_kernel({5, 0, 2, 1}), {5, 0, 2, 1}},
      {by_kernel({3, 3, 2, 2, 2, 1, 1, 1, 1}), {3, 3, 2, 2, 2, 1, 1, 1, 1}}};
  std::vector<float> ao(41 * 37, 0.0f);
  ao[18 * 41 + 20] = 1;
  for (const auto& [what, rendering] : slanted_planes({0, 30, 60, 80}, {0, 37, 200}, {10, 0}, 41, 37))
    for (const auto& [settings, weights] : cases) {
      double sum = -weights[0];
      for (const double weight : weights) sum += 2 * weight;
      const auto weight_at = [&, &weights = weights](int at) {
        return std::size_t(std::abs(at)) < weights.size() ? weights[std::size_t(std::abs(at))] / sum : 0;
      };
      const auto expected = [&](std::size_t i) { return weight_at(int(i % 41) - 20) * weight_at(int(i / 41) - 18); };
      const auto d = difference(denoised(rendering.frame, ao, settings), expected);
      EXPECT_LE(d.max, 1e-5) << name_of(settings) << ", " << what << " " << place(d, rendering.frame);
    }
}

// At the border the weights are those of the pixels that there are.
TEST(Denoise, repeats_no_pixel_of_the_border) {
  const HostFrame frame = slanted_planes({0}, {0}, {60}, 41, 37)[0].rendering.frame;
  std::vector<float> ao(41 * 37, 0.0f);
  ao.front() = ao.back() = 1;
  const std::vector<float> result = denoised(frame, ao, by_kernel({5, 3, 1}));
  for (const std::size_t last : {std::size_t(0), ao.size() - 1}) EXPECT_NEAR(result[last], 25.0 / 81, 1e-5);
  EXPECT_NEAR(result[1], 3.0 / 12 * 5 / 9, 1e-5);
}

TEST(Denoise, of_the_mirrored_frame_is_the_mirrored_result) {
  const Rendering room = furnished_room(101, 75);
  const std::vector<float> ao = noise_over(room);
  for (const EstimatorSettings& settings : all_denoisers()) {
    const std::vector<float> upright = denoised(room.frame, ao, settings);
    EXPECT_GT(difference(upright, ao).rmse, 0.01) << name_of(settings);
    for (const bool left_right : {true, false}) {
      const std::vector<float> result =
          denoised(mirrored(room.frame, left_right), mirrored(ao, room.frame, left_right), settings);
      const auto d = difference(result, mirrored(upright, room.frame, left_right));
      EXPECT_LE(d.max, 1e-4) << name_of(settings) << place(d, room.frame);
    }
  }
}

}  // namespace
}  // namespace alcove::denoise_test
