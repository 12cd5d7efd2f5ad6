// What the tests of closed forms share: kernel and reference, compared with the truth over a picture of a scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>

#include "core/chain/compute.h"
#include "core/reference/reference.h"
#include "tests/support/device.h"
#include "tests/support/long_tests.h"
#include "tests/support/scenes.h"

namespace alcove::test {

constexpr double kPi = std::numbers::pi;
constexpr double kMaxError = 0.02, kMeanError = 0.005;  // at 16 slices of 64 steps
constexpr double kUnlimited = 1e3;                      // a radius larger than any scene here
// that a radius must span on the receiver: near a horizon no search can resolve it
constexpr double kLeastPixels = 16;

inline EstimatorSettings fine(double radius) {
  EstimatorSettings settings = plain_settings();
  settings.radius = radius;
  settings.slices = 16;
  settings.steps = 64;
  return settings;
}

/// A camera among several, with its name for messages.
struct NamedShot {
  const char* name;
  Shot shot;
};

/// The truth at a surface; none where the picture doesn't show all that the truth depends on.
using Truth = std::function<std::optional<double>(const Hit&)>;

/// Worst and mean errors over the pictures of one test.
class ClosedForm : public testing::Test {
 protected:
  /// Compares the AO of every pixel that has a truth and isn't within a pixel of an edge, or two of a vertex, where an
  /// occluder is a few pixels.
  void compare(const char* picture, const Scene& scene, const Shot& shot, const EstimatorSettings& settings,
               const Truth& truth, int least_pixels) {
    const Rendering rendering = render(scene, shot);
    const HostResult result = compute_ao(recorder(), rendering.frame, settings);
    double worst = 0, sum = 0, bias = 0;
    int pixels = 0;
    std::string where;
    std::vector<std::pair<std::size_t, double>> truths;
    for (int y = 0; y < shot.data.height; y++) {
      for (int x = 0; x < shot.data.width; x++) {
        const Hit& hit = rendering.at(x, y);
        if (hit.primitive < 0 || rendering.primitives_within(1, x, y) > 1 || rendering.primitives_within(2, x, y) > 2 ||
            kLeastPixels * rendering.footprint(x, y) > settings.radius.value())
          continue;
        const std::optional<double> expected = truth(hit);
        if (!expected) continue;
        truths.emplace_back(std::size_t(y * shot.data.width + x), *expected);
        const double ao = result.ao[truths.back().first], error = std::abs(ao - *expected);
        pixels++;
        sum += error;
        bias += ao - *expected;
        if (error <= worst) continue;
        worst = error;
        where = "pixel " + std::to_string(x) + " " + std::to_string(y) + " of primitive " +
                std::to_string(hit.primitive) + ": " + std::to_string(ao) + " for " + std::to_string(*expected);
      }
    }
    EXPECT_GE(pixels, least_pixels) << picture;
    EXPECT_LE(worst, kMaxError) << picture << ", " << where;
    EXPECT_LE(sum / pixels, kMeanError) << picture << ", mean signed error " << bias / pixels << " over " << pixels
                                        << " pixels";
    compare_reference(picture, rendering.frame, settings, truths);
    max_error_ = std::max(max_error_, worst);
    mean_error_ = std::max(mean_error_, sum / pixels);
    least_pixels_ = std::min(least_pixels_, pixels);
  }

  void TearDown() override {
    RecordProperty("max_error", std::to_string(max_error_));
    RecordProperty("mean_error", std::to_string(mean_error_));
    RecordProperty("least_pixels", least_pixels_);
  }

  // of the CPU reference at 64 slices; what is left comes from the size of the pixels
  double reference_mean_error_ = 0.002;

 private:
  /// The CPU reference at some of the pixels.
  void compare_reference(const char* picture, const HostFrame& frame, const EstimatorSettings& settings,
                         const std::vector<std::pair<std::size_t, double>>& truths) {
    constexpr std::size_t kPixels = 25;
    ReferenceSettings reference;
    reference.radius = *settings.radius;
    reference.falloff = settings.falloff;
    reference.falloff_start = settings.falloff_start;
    reference.slices = 64;
    std::vector<double> expected;
    for (std::size_t i = 0; i < std::min(kPixels, truths.size()); i++) {
      const auto& [pixel, truth] = truths[i * truths.size() / std::min(kPixels, truths.size())];
      reference.pixels.push_back(pixel);
      expected.push_back(truth);
    }
    const auto ao = reference_ao(frame, reference);
    double sum = 0, bias = 0, worst = 0;
    for (std::size_t i = 0; i < expected.size(); i++) {
      const double error = ao[reference.pixels[i]] - expected[i];
      sum += std::abs(error) / double(expected.size());
      bias += error / double(expected.size());
      worst = std::max(worst, std::abs(error));
    }
    EXPECT_LE(sum, reference_mean_error_)
        << picture << ": the CPU reference, mean signed error " << bias << ", largest " << worst;
  }

  double max_error_ = 0, mean_error_ = 0;
  int least_pixels_ = 1 << 30;
};

}  // namespace alcove::test
