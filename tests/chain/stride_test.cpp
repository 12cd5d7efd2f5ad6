// Estimates at one pixel of two or four in a row, given to the others by the denoiser.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/estimator_facts.h"
#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/scenes.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using namespace test;

EstimatorSettings sparse_settings(double radius, int stride, int denoise_radius = 4) {
  EstimatorSettings settings;
  settings.radius = radius;
  settings.slices = 2;
  settings.steps = 12;
  settings.stride = stride;
  settings.denoise = Denoise::bilateral;
  settings.denoise_radius = denoise_radius;
  return settings;
}

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

class Sparse : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Estimate, Sparse, testing::Values(2, 4));

TEST_P(Sparse, every_pixel_of_a_plane_is_open_at_any_size_and_filter) {
  for (const int radius : {1, 2, 3, 8})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {2, 7}, {13, 1}, {31, 17}, {64, 40}}) {
      const Rendering plane = render(Scene{{parallelogram({-50, -50, 0}, {100, 0, 0}, {0, 100, 0})}},
                                     Shot::perspective({0, -3, 2}, {0, 0, 0}, 50, width, height));
      for (const float value : run(plane.frame, sparse_settings(1, GetParam(), radius)))
        ASSERT_EQ(value, 1.0f) << width << " x " << height << ", radius " << radius;
    }
}

// What the estimate leaves out is never read, whatever the memory held before.
TEST_P(Sparse, pixels_without_an_estimate_may_hold_anything) {
  const Rendering room = furnished_room(31, 17);
  const std::vector<float> expected = run(room.frame, sparse_settings(1, GetParam()));
  for (float& value : recorder().buffer("ao", expected.size() * sizeof(float), gpu::Use::download).as<float>())
    value = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(same_bits(run(room.frame, sparse_settings(1, GetParam())), expected));
}

// Nothing is left without an estimate, be it alone on its surface or beside the sky.
TEST_P(Sparse, is_as_near_to_the_dense_estimate_as_noise_allows) {
  const Rendering room = furnished_room(192, 144);
  EstimatorSettings many = sparse_settings(0.5, 1, 1);
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

// The pixels that are estimated are counted from the display window.
TEST_P(Sparse, crop_is_the_whole_frame_there) {
  const Rendering whole = furnished_room(160, 120);
  const EstimatorSettings settings = sparse_settings(0.1, GetParam());
  const std::vector<float> expected = run(whole.frame, settings);
  const Window window{37, 21, 90, 73};
  HostFrame crop = whole.frame;
  crop.data = window;
  crop.depth = cropped(whole.frame.depth, whole.frame.data, window);
  crop.normal.clear();
  const std::size_t pixels = whole.frame.data.pixels();
  for (std::size_t axis = 0; axis < 3; axis++) {
    const auto plane = cropped({whole.frame.normal.data() + axis * pixels, pixels}, whole.frame.data, window);
    crop.normal.insert(crop.normal.end(), plane.begin(), plane.end());
  }
  const std::vector<float> ao = run(crop, settings);
  const int margin = 30;
  int darkened = 0;
  for (int y = margin; y < window.height - margin; y++)
    for (int x = margin; x < window.width - margin; x++) {
      const float value = ao[std::size_t(y) * std::size_t(window.width) + std::size_t(x)];
      EXPECT_EQ(value, expected[std::size_t(y + window.y) * 160 + std::size_t(x + window.x)]) << x << " " << y;
      darkened += value < 0.98;
    }
  EXPECT_GT(darkened, 20);
}

TEST(Stride, left_open_is_sparse_only_where_the_denoiser_shares) {
  EstimatorSettings settings = sparse_settings(1, 0);
  EXPECT_EQ(stride_of(settings), 4);
  settings.slices = 3;
  EXPECT_EQ(stride_of(settings), 1);
  settings.slices = 1;
  settings.denoise = Denoise::none;
  EXPECT_EQ(stride_of(settings), 1);
  settings.denoise = Denoise::bilateral;
  settings.estimator = Estimator::hbao;
  EXPECT_EQ(stride_of(settings), 1);
  settings.estimator = Estimator::gtao;
  settings.resolution = Resolution::half;
  EXPECT_EQ(stride_of(settings), 1);
  settings.stride = 2;
  EXPECT_EQ(stride_of(settings), 2);
}

}  // namespace
}  // namespace alcove
