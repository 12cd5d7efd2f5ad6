// How far each estimator is from its reference in double precision, and that this grows no faster than the depth's own precision explains.
// SPDX-License-Identifier: BSD-3-Clause
//
// The bound. A depth that is off by d turns the direction to a sample one pixel aside by no more than d / p, p the width of a pixel there; both the
// sample's and the receiver's depth may be off, and visibility changes by no more than the angle: 2 d / p. Farther samples turn less. So the RMSE is at most
// the root mean square of min(1, 2 d / p), what the drawn samples leave (kSampling, that of exact depth), and what a sphere of few pixels leaves to chance: whether
// the one next pixel is within it (kFewPixels p / R; below a pixel nothing is).
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/reference.h"
#include "core/reference_estimators.h"
#include "tests/device.h"
#include "tests/difference.h"
#include "tests/stability/cases.h"

namespace alcove {
namespace {

using namespace test;

/// Of 16 slices with a sample at every pixel, or 64 samples. With a constant thickness gtao takes the receiver's own surface for endless, and its reference does not.
const std::map<std::string, double> kSampling{{"gtao", 0.02}, {"gtao infinite", 0.015}, {"gtao constant", 0.055}, {"gtao exact", 0.02},
                                              {"bitmask", 0.02}, {"hbao", 0.03}, {"crytek", 0.03}};
constexpr double kFewPixels = 0.2;

std::vector<float> reference_of(const HostFrame& frame, const EstimatorSettings& settings, const std::vector<std::size_t>& pixels) {
  if (settings.estimator == Estimator::hbao || settings.estimator == Estimator::crytek) return reference_estimate(frame, settings, pixels);
  ReferenceSettings reference = reference_settings_of(settings);
  reference.pixels = pixels;
  return reference_ao(frame, reference);
}

/// Half a step of a storage at a depth.
double step_at(Storage storage, double z, double near, double far) {
  switch (storage) {
    case Storage::single_float: return z * 0x1p-24;
    case Storage::half_float: return z * 0x1p-11;
    default: return z * z * (1 / near - 1 / far) * (storage == Storage::bits_16 ? 0x1p-17 : 0x1p-25);
  }
}

class Accuracy : public testing::Test {
 protected:
  void expect(const Spec& spec) {
    Spec clean = spec;
    clean.storage = Storage::single_float;
    clean.width = 48;
    clean.height = 36;
    const Case exact = made(clean);
    Spec kept = clean;
    kept.storage = spec.storage;
    const Case tried = made(kept);
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < exact.frame.depth.size(); i += 5)
      if (exact.frame.depth[i] < exact.frame.sky) pixels.push_back(i);
    ASSERT_GT(pixels.size(), 100u);
    const double room_depth = tried.frame.depth_range.near.value_or(1) * 10;
    for (const auto& variant : estimators()) {
      EstimatorSettings settings = with_radius(variant.settings, exact.radius);
      settings.slices = 16;
      settings.steps = 64;
      settings.samples = 64;
      const std::vector<float> reference = reference_of(exact.frame, settings, pixels), ao = compute_ao(recorder(), tried.frame, settings).ao;
      double sum = 0, turned = 0, few = 0;
      const auto count = double(pixels.size());
      for (const std::size_t i : pixels) {
        const double z = exact.frame.depth[i];
        const double pixel = (exact.frame.camera.orthographic ? 1 : z) / exact.frame.camera.fx, highest = pixel * std::max(1.0, exact.frame.camera.fx / exact.frame.camera.fy);
        const double turn = std::min(1.0, 2 * step_at(spec.storage, z, 0.1 * room_depth, 1000 * room_depth) / pixel);
        sum += (ao[i] - reference[i]) * (ao[i] - reference[i]);
        turned += turn * turn;
        if (exact.radius > pixel) few += std::pow(kFewPixels * highest / exact.radius, 2);
      }
      const double rmse = std::sqrt(sum / count), bound = kSampling.at(variant.name) + std::sqrt(turned / count) + std::sqrt(few / count);
      RecordProperty(variant.name + ", " + to_string(spec), std::to_string(rmse));
      EXPECT_LE(rmse, bound) << variant.name << ": " << to_string(spec);
    }
  }
};

TEST_F(Accuracy, of_the_room) { expect({}); }

TEST_F(Accuracy, at_every_scale) {
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6, 1e9}) expect({.scale = scale});
}

TEST_F(Accuracy, before_a_background_a_million_times_as_far) {
  for (const double range : {1e2, 1e4, 1e6}) expect({.range = range});
}

TEST_F(Accuracy, at_every_field_of_view) {
  for (const double fov : {0.0, 0.5, 5.0, 90.0, 120.0, 150.0, 170.0}) expect({.fov = fov});
}

TEST_F(Accuracy, through_shifted_lenses_and_oblong_pixels) {
  for (const double aspect : {0.25, 0.5, 4.0}) expect({.aspect = aspect});
  expect({.shift = 0.4});
}

TEST_F(Accuracy, at_every_radius) {
  for (const double radius : {1e-9, 1e-4, 0.01, 0.05, 1.0}) expect({.radius = radius});
}

TEST_F(Accuracy, of_depth_stored_with_few_bits) {
  for (const Storage storage : {Storage::half_float, Storage::bits_16, Storage::bits_24, Storage::bits_24_reversed}) expect({.fov = 1.5, .storage = storage});  // pixels as small as in a picture 1920 wide
}

}  // namespace
}  // namespace alcove
