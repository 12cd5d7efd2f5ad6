// Rendered frames against Cycles' ray-traced AO, from files through the whole chain.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "core/chain/compute.h"
#include "core/formats/exr.h"
#include "core/frame/gbuffer.h"
#include "tests/support/device.h"

namespace alcove {
namespace {

struct Crop {
  HostFrame frame;
  std::vector<float> truth_a, truth_b;
};

Crop load(const std::string& scene) {
  const std::string base = ALCOVE_SOURCE_DIR "/examples/bench/" + scene;
  InputSettings settings;
  settings.input = base + ".gbuffer.exr";
  settings.camera = base + ".camera.json";
  Crop crop;
  crop.frame = read_host_frame(settings, 0);
  crop.truth_a = read_exr_image(base + ".ao.a.exr").pixels;
  crop.truth_b = read_exr_image(base + ".ao.b.exr").pixels;
  return crop;
}

/// Root mean squared error over surfaces without the truth's noise: mean of (t - a)(t - b).
double unbiased_rmse(const Crop& crop, const std::vector<float>& result) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < result.size(); i++) {
    if (!(crop.frame.depth[i] < 1e9f)) continue;
    sum += (double(result[i]) - crop.truth_a[i]) * (double(result[i]) - crop.truth_b[i]);
    count++;
  }
  return std::sqrt(sum / double(count));
}

EstimatorSettings eight_by_sixteen(double radius) {
  EstimatorSettings settings = test::plain_settings();
  settings.radius = radius;
  settings.slices = 8;
  settings.steps = 16;
  return settings;
}

// Measured 0.0903 and 0.0861 (limits 0.095 and 0.090): what is left is geometry that one depth layer does not show.
TEST(RealFrame, monkeys_agree_with_ray_tracing) {
  const Crop crop = load("monkeys");
  EXPECT_LE(unbiased_rmse(crop, compute_ao(test::recorder(), crop.frame, eight_by_sixteen(0.5)).ao), 0.095);
}

TEST(RealFrame, colonnade_agrees_with_ray_tracing) {
  const Crop crop = load("colonnade");
  EXPECT_LE(unbiased_rmse(crop, compute_ao(test::recorder(), crop.frame, eight_by_sixteen(0.75)).ao), 0.090);
}

TEST(RealFrame, normals_from_depth_come_close_to_the_rendered_ones) {
  Crop crop = load("colonnade");
  const auto with_normals = compute_ao(test::recorder(), crop.frame, eight_by_sixteen(0.75)).ao;
  crop.frame.normal.clear();
  const auto without = compute_ao(test::recorder(), crop.frame, eight_by_sixteen(0.75)).ao;
  double sum = 0;
  for (std::size_t i = 0; i < without.size(); i++) sum += std::pow(double(with_normals[i]) - without[i], 2);
  // measured 0.0718; the rendered normals are smooth over facets
  EXPECT_LE(std::sqrt(sum / double(without.size())), 0.08);
}

}  // namespace
}  // namespace alcove
