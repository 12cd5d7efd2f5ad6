// HBAO and Crytek's estimator against their own expected values, whose derivations stand beside the tests, and against
// slow versions of themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/chain/compute.h"
#include "core/reference/reference_estimators.h"
#include "tests/support/block_scene.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"

namespace alcove {
namespace {

using test::block, test::leaning;
using test::Difference, test::difference, test::place, test::same_bits;
using test::Plane, test::Polygon, test::Rendering, test::Scene, test::Shot, test::Sphere, test::unit, test::Vec3;

constexpr double kPi = std::numbers::pi, kRadian = kPi / 180;

EstimatorSettings hbao(double radius, int slices = 16, int steps = 128) {
  EstimatorSettings settings = test::plain_settings();
  settings.estimator = Estimator::hbao;
  settings.radius = radius;
  settings.slices = slices;
  settings.steps = steps;
  return settings;
}

EstimatorSettings crytek(double radius, SampleKernel kernel = SampleKernel::uniform,
                         RangeCheck check = RangeCheck::none) {
  EstimatorSettings settings = test::plain_settings();
  settings.estimator = Estimator::crytek;
  settings.radius = radius;
  settings.samples = 64;
  settings.sample_kernel = kernel;
  settings.range_check = check;
  return settings;
}

/// Every estimator here with its variants.
std::vector<EstimatorSettings> all_variants(double radius) {
  std::vector<EstimatorSettings> all;
  for (const Elevation elevation : {Elevation::view, Elevation::surface})
    for (const Falloff falloff : {Falloff::none, Falloff::linear, Falloff::quadratic, Falloff::smooth}) {
      all.push_back(hbao(radius, 3, 8));
      all.back().elevation = elevation;
      all.back().falloff = falloff;
      all.back().falloff_start = 0.2;
    }
  for (const SampleKernel kernel : {SampleKernel::clustered, SampleKernel::uniform})
    for (const RangeCheck check : {RangeCheck::none, RangeCheck::ratio, RangeCheck::smoothstep}) {
      all.push_back(crytek(radius, kernel, check));
      all.back().samples = check == RangeCheck::none ? 7 : 16;
    }
  return all;
}

std::string name_of(const EstimatorSettings& s) {
  return s.estimator == Estimator::hbao
             ? "hbao, elevation " + std::to_string(int(s.elevation)) + ", falloff " + std::to_string(int(s.falloff))
             : "crytek, kernel " + std::to_string(int(s.sample_kernel)) + ", range check " +
                   std::to_string(int(s.range_check));
}

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(test::recorder(), frame, settings).ao;
}

/// Compares the mean AO over all receivers that have an expected value with the mean of what is expected, and each of
/// them with a looser bound.
void expect_mean(const Rendering& rendering, const EstimatorSettings& settings,
                 const std::function<double(const test::Hit&)>& expected, double mean_tolerance, double tolerance,
                 int least_pixels, const std::string& what) {
  const std::vector<float> ao = run(rendering.frame, settings);
  double sum = 0, worst = 0;
  int count = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    const double value = expected(rendering.hits[i]);  // NaN: none
    if (std::isnan(value)) continue;
    count++;
    sum += ao[i] - value;
    worst = std::max(worst, std::abs(ao[i] - value));
  }
  EXPECT_GE(count, least_pixels) << what;
  EXPECT_LE(std::abs(sum / count), mean_tolerance)
      << what << ", mean error " << sum / count << " over " << count << " pixels";
  EXPECT_LE(worst, tolerance) << what;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// HBAO, after Bavoil and Sainz: the mean of sin h - sin t over the azimuth, which weighs the hemisphere uniformly and
// not by the cosine.

// In the azimuth phi from the wall its rim stands at sin h = H / sqrt(H^2 + d^2 / cos^2 phi), as long as d / cos phi <
// R. An endless wall blocks acos(d / R) / pi.
double hbao_beside_wall(double d, double height, double radius) {
  constexpr int kParts = 2000;
  const double limit = std::acos(std::min(1.0, d / radius));
  double sum = 0;
  for (int i = 0; i < kParts; i++)
    sum += height / std::hypot(height, d / std::cos(limit * (i + 0.5) / kParts)) / kParts;
  return 1 - sum * limit / kPi;
}

TEST(Hbao, beside_an_endless_wall_seen_along_the_normal_is_1_minus_acos_c_over_pi) {
  const Rendering rendering = test::render(block(50), leaning(0, 3, 300, 200));
  EXPECT_NEAR(hbao_beside_wall(0.5, 1e6, 1), 1 - std::acos(0.5) / kPi, 1e-6);
  for (const double c : {0.1, 0.3, 0.5, 0.8})
    expect_mean(
        rendering, hbao(0.6),
        [&](const test::Hit& hit) {
          const bool here =
              hit.primitive == 0 && std::abs(hit.position.x - 0.6 * c) < 0.006 && std::abs(hit.position.y) < 0.35;
          return here ? 1 - std::acos(hit.position.x / 0.6) / kPi : kNone;
        },
        0.01, 0.04, 50, "c = " + std::to_string(c));
}

TEST(Hbao, beside_a_finite_wall_is_the_mean_sine_of_its_rim) {
  for (const double height : {0.2, 0.5, 1.0}) {
    const Rendering rendering = test::render(block(height), leaning(0, 3, 300, 200));
    for (const double d : {0.1, 0.25, 0.4})
      expect_mean(
          rendering, hbao(0.6),
          [&](const test::Hit& hit) {
            const bool here =
                hit.primitive == 0 && std::abs(hit.position.x - d) < 0.006 && std::abs(hit.position.y) < 0.35;
            return here ? hbao_beside_wall(hit.position.x, height, 0.6) : kNone;
          },
          0.01, 0.03, 50, "height " + std::to_string(height) + " d " + std::to_string(d));
  }
}

// Perfect horizons: half of the hemisphere beside an endless wall, a quarter below a rim at 45 degrees, whatever the
// tilt of the view. The part of the uniform hemisphere that a rectangle of width 2 w at distance d, standing on the
// tangent plane, fills (van Oosterom and Strackee).
double rectangle_share(double d, double height, double from, double to) {
  const auto quarter = [&](double w) {
    return std::asin(w * height / std::sqrt((w * w + d * d) * (height * height + d * d)));
  };
  return (quarter(to) - quarter(from)) / (2 * kPi);
}

TEST(Hbao, sees_the_uniform_hemisphere_at_every_tilt_of_the_view) {
  EXPECT_NEAR(rectangle_share(1, 1e7, -1e7, 1e7), 0.5, 1e-6);  // an endless wall: 0.5
  // a rim at 45 degrees: 0.25, where the cosine-weighted is 0.146
  EXPECT_NEAR(rectangle_share(1, 1, -1e7, 1e7), 0.25, 1e-6);
  constexpr double kHalf = 3;
  for (const double tilt : {0.0, 30.0, 60.0, 75.0}) {
    // Pixels oblong in y: the picture is long and has few of them.
    Shot shot = leaning(tilt, 6, 300, 120);
    shot.camera.fy = 120 / (2 * kHalf);
    for (const auto& [height, d] : {std::pair{1.0, 1.0}, {2.0, 0.2}}) {
      const Rendering rendering = test::render(block(height), shot);
      expect_mean(
          rendering, hbao(1e3, 32, 512),
          [&, d = d, height = height](const test::Hit& hit) {
            const bool here =
                hit.primitive == 0 && std::abs(hit.position.x - d) < 0.05 && std::abs(hit.position.y) < 0.2;
            return here ? 1 - rectangle_share(hit.position.x, height, -kHalf - hit.position.y, kHalf - hit.position.y)
                        : kNone;
          },
          0.01, 0.03, 8, "tilt " + std::to_string(tilt) + " height " + std::to_string(height));
    }
  }
}

// Without the weights that the kernel's head describes, even directions of the image get this wrong.
TEST(Hbao, off_axis_is_what_it_is_on_axis) {
  const double half = 0.4, height = 0.3;
  const Scene scene{
      {Plane{.point = {}, .normal = {0, 0, 1}}, test::parallelogram({0, -half, 0}, {0, 2 * half, 0}, {0, 0, height})}};
  for (const double aside : {0.0, 0.6, 1.0}) {
    const Shot shot = Shot::perspective({1, aside, 1.2}, {1, aside, 0}, 120, 320, 320);
    expect_mean(
        test::render(scene, shot), hbao(1e3, 16, 256),
        [&](const test::Hit& hit) {
          const bool here =
              hit.primitive == 0 && std::abs(hit.position.x - 0.3) < 0.02 && std::abs(hit.position.y) < 0.1;
          return here ? 1 - rectangle_share(hit.position.x, height, -half - hit.position.y, half - hit.position.y)
                      : kNone;
        },
        0.01, 0.03, 20, "aside " + std::to_string(aside));
  }
}

TEST(Hbao, from_the_surface_is_the_same_where_it_faces_the_eye_and_the_sine_above_it_elsewhere) {
  for (const double tilt : {0.0, 40.0}) {
    const Rendering rendering = test::render(block(0.5), leaning(tilt, 3, 300, 200));
    EstimatorSettings settings = hbao(100);
    settings.elevation = Elevation::surface;
    const std::vector<float> surface = run(rendering.frame, settings), view = run(rendering.frame, hbao(100));
    const Difference d = difference(surface, view);
    if (tilt == 0)
      EXPECT_LE(d.max, 1e-4) << place(d, rendering.frame);
    else
      EXPECT_GE(d.rmse, 0.01);
    std::vector<std::size_t> some;
    for (std::size_t i = 50; i < surface.size(); i += 977) some.push_back(i);
    const std::vector<float> slow = reference_estimate(rendering.frame, settings, some);
    for (const std::size_t i : some) EXPECT_NEAR(surface[i], slow[i], 0.04) << "tilt " << tilt << " pixel " << i;
  }
}

// On a vertical wall a sample at height h is sqrt(d^2 + h^2) away, so what is blocked is the integral of W d(sin h).
TEST(Hbao, attenuation_weighs_every_rise_of_the_horizon) {
  const double radius = 1;
  // Not seen from straight above; from aside a uniform hemisphere is the same, so the slow version must agree with the
  // kernel there.
  const Rendering rendering = test::render(block(2), leaning(45, 4, 200, 150));
  for (const Falloff falloff : {Falloff::linear, Falloff::quadratic, Falloff::smooth}) {
    EstimatorSettings settings = hbao(radius);
    settings.falloff = falloff;
    settings.falloff_start = 0.3;
    const std::vector<float> ao = run(rendering.frame, settings), plain = run(rendering.frame, hbao(radius));
    std::vector<std::size_t> some;
    for (std::size_t i = 50; i < ao.size(); i += 377) some.push_back(i);
    const std::vector<float> slow = reference_estimate(rendering.frame, settings, some);
    double sum = 0;
    for (const std::size_t i : some) {
      sum += std::abs(ao[i] - slow[i]) / double(some.size());
      EXPECT_GE(ao[i], plain[i] - 1e-4) << "attenuation only lightens";
    }
    EXPECT_LE(sum, 0.005) << "falloff " << int(falloff);
  }
}

// A rim at that elevation blocks nothing, and a higher rim blocks what lies between.
TEST(Hbao, bias_is_the_sine_of_the_least_elevation) {
  const double d = 0.4;
  for (const double height : {0.1, 0.4}) {
    const Rendering rendering = test::render(block(height), leaning(0, 3, 300, 200));
    for (const Elevation elevation : {Elevation::view, Elevation::surface}) {
      EstimatorSettings settings = hbao(0.6);
      settings.bias = 0.5;
      settings.elevation = elevation;
      constexpr int kParts = 2000;
      expect_mean(
          rendering, settings,
          [&](const test::Hit& hit) {
            if (hit.primitive != 0 || std::abs(hit.position.x - d) > 0.006 || std::abs(hit.position.y) > 0.35)
              return kNone;
            const double limit = std::acos(hit.position.x / 0.6);
            double sum = 0;
            for (int i = 0; i < kParts; i++)
              sum += std::max(0.0, height / std::hypot(height, hit.position.x / std::cos(limit * (i + 0.5) / kParts)) -
                                       0.5) /
                     kParts;
            return 1 - sum * limit / kPi;
          },
          0.005, 0.02, 50, "height " + std::to_string(height) + " elevation " + std::to_string(int(elevation)));
    }
  }
}

// Crytek's estimator: the hidden part of the volume.

// The visibility is 1 - (1 - c)^2 (2 + c) / 4, from wherever on the open side it is seen.
TEST(Crytek, beside_an_endless_wall_is_the_volume_before_it) {
  for (const Shot& shot : {Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 320, 240),
                           Shot::perspective({5, 0, 1.5}, {0, 0, 0.6}, 50, 320, 240),
                           Shot::perspective({2.2, -0.6, 1.8}, {0.6, 0.2, 0.2}, 100, 320, 240),
                           Shot::orthographic({4, -1, 3}, {0.5, 0, 0.5}, 5, 320, 240)}) {
    const Rendering rendering =
        test::render({{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}}}}, shot);
    for (const double c : {0.1, 0.3, 0.5, 0.7})
      expect_mean(
          rendering, crytek(1),
          [&](const test::Hit& hit) {
            const double d = hit.primitive == 0 ? hit.position.x : hit.position.z;
            return std::abs(d - c) < 0.05 && shot.sees_ball(hit.position, 1) ? 1 - (1 - d) * (1 - d) * (2 + d) / 4
                                                                             : kNone;
          },
          0.008, 0.12, 100, "c = " + std::to_string(c) + " fx " + std::to_string(shot.camera.fx));
  }
}

// A sample of length s R is behind the wall with probability (1 - c / s) / 2.
TEST(Crytek, clustered_kernel_has_the_lengths_of_its_formula) {
  const Shot shot = Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 320, 240);
  const Rendering rendering =
      test::render({{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}}}}, shot);
  for (const int samples : {8, 64}) {
    EstimatorSettings settings = crytek(1, SampleKernel::clustered);
    settings.samples = samples;
    expect_mean(
        rendering, settings,
        [&](const test::Hit& hit) {
          const double c = hit.primitive == 0 ? hit.position.x : hit.position.z;
          if (c < 0.1 || c > 0.4 || !shot.sees_ball(hit.position, 1)) return kNone;
          double blocked = 0;
          for (int i = 0; i < samples; i++) {
            const double longest = 0.1 + 0.9 * std::pow(double(i) / samples, 2);  // s = u longest, u even in [0, 1)
            if (longest > c) blocked += 0.5 * (1 - c / longest * (1 + std::log(longest / c))) / samples;
          }
          return 1 - blocked;
        },
        0.004, 0.3, 500, std::to_string(samples) + " samples");
  }
}

TEST(Crytek, range_checks_weigh_a_hit_by_its_depth) {
  // A floor seen from straight above and a block so high that all of it is dz before the floor: every hit weighs the
  // same.
  const double radius = 0.5;
  for (const double dz : {0.25, 0.4, 1.0, 2.0}) {
    const Rendering rendering = test::render(block(dz), leaning(0, 3, 150, 100));
    const std::vector<float> plain = run(rendering.frame, crytek(radius));
    const auto smooth = [](double x) {
      const double t = std::clamp(x, 0.0, 1.0);
      return t * t * (3 - 2 * t);
    };
    for (const auto& [check, weight] :
         {std::pair{RangeCheck::ratio, smooth(radius / dz)}, {RangeCheck::smoothstep, 1 - smooth(dz / radius)}}) {
      const std::vector<float> ao = run(rendering.frame, crytek(radius, SampleKernel::uniform, check));
      double occluded = 0;
      for (std::size_t i = 0; i < ao.size(); i++) {
        EXPECT_NEAR(1 - ao[i], weight * (1 - plain[i]), 1e-5)
            << "dz " << dz << " check " << int(check) << " pixel " << i;
        occluded += 1 - plain[i];
      }
      EXPECT_GT(occluded, 100) << "there is something to weigh";
    }
  }
}

TEST(Crytek, bias_is_a_depth_in_scene_units) {  // what is nearer to the eye than the sample by less does not hide it
  const Rendering rendering = test::render(block(0.3), leaning(0, 3, 150, 100));
  EstimatorSettings settings = crytek(0.5);
  settings.bias = 0.31;
  EXPECT_LE(difference(run(rendering.frame, settings), [](std::size_t) { return 1.0; }).max, 0);
  // Over the block from above, the samples lower than 0.3 - bias are hidden: those of a ball's slab beside the block's
  // side.
  settings.bias = 0.1;
  const double radius = 0.5, low = 0.2, d = 0.1;
  constexpr int kParts = 400;
  double hidden = 0;  // volume of the half ball beyond x = d and below z = low
  for (int i = 0; i < kParts; i++) {
    const double z = low * (i + 0.5) / kParts, r = std::sqrt(radius * radius - z * z), c = d / r;
    hidden += (std::acos(c) - c * std::sqrt(1 - c * c)) * r * r * low / kParts;
  }
  expect_mean(
      rendering, settings,
      [&](const test::Hit& hit) {
        const bool here = hit.primitive == 0 && std::abs(hit.position.x - d) < 0.011 && std::abs(hit.position.y) < 0.4;
        return here ? 1 - hidden / (2 * kPi / 3 * std::pow(radius, 3)) : kNone;
      },
      0.015, 0.1, 20, "beside the block");
}

// On the command line.

TEST(EstimatorOptions, tells_how_many_samples_each_estimator_takes) {
  const test::TemporaryFolder folder;
  const std::string frame = ALCOVE_SOURCE_DIR "/examples/bench/machine.";
  using Options = std::vector<std::string>;
  for (const auto& [estimator, options, samples] :
       {std::tuple<std::string, Options, double>{"hbao", {"--slices", "3", "--steps", "5"}, 2 * 3 * 5},
        {"crytek", {"--samples", "9"}, 9}}) {
    Options arguments{"run",         frame + "gbuffer.exr",
                      "--camera",    frame + "camera.json",
                      "--radius",    "0.006",
                      "--estimator", estimator,
                      "-o",          folder / (estimator + ".exr"),
                      "--stats",     folder / "stats.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const test::Finished finished = test::run_program(arguments);
    ASSERT_EQ(finished.code, 0) << finished;
    const auto stats = nlohmann::json::parse(test::read_bytes(folder / "stats.json"))["frames"][0];
    const double surfaces = 1 - stats["sky_pixels"].get<double>() / stats["pixels"].get<double>();
    EXPECT_DOUBLE_EQ(stats["samples_per_pixel"].get<double>(), samples * surfaces) << estimator;
  }
}

TEST(EstimatorOptions, refuses_a_sine_of_one_and_more_as_a_bias) {
  const test::TemporaryFolder folder;
  const std::string frame = ALCOVE_SOURCE_DIR "/examples/bench/machine.";
  const test::Finished finished =
      test::run_program({"run", frame + "gbuffer.exr", "--camera", frame + "camera.json", "--radius", "1",
                         "--estimator", "hbao", "--set", "bias=1", "-o", folder / "ao.exr"});
  EXPECT_EQ(finished.code, 2) << finished;
  EXPECT_NE(finished.err.find("--set bias"), std::string::npos) << finished;
}

// Both, whatever the variant.

TEST(EveryVariant, leaves_a_flat_plane_open) {
  for (const double tilt : {0.0, 30.0, 60.0, 80.0, 85.0})
    for (const double turn : {0.0, 37.0, 200.0}) {
      const double sine = std::sin(tilt * kRadian);
      const Scene scene{{Plane{
          .point = {5, 0, 0},
          .normal = {-std::cos(tilt * kRadian), sine * std::cos(turn * kRadian), sine * std::sin(turn * kRadian)}}}};
      for (const double fov : {0.0, 60.0, 120.0}) {
        const Shot shot =
            fov > 0 ? Shot::perspective({}, {1, 0, 0}, fov, 64, 48) : Shot::orthographic({}, {1, 0, 0}, 0.5, 64, 48);
        const Rendering rendering = test::render(scene, shot);
        for (const double radius : {0.01, 0.5, 10.0})
          for (const auto& settings : all_variants(radius)) {
            const Difference d = difference(run(rendering.frame, settings), [](std::size_t) { return 1.0; });
            EXPECT_LE(d.max, 0) << name_of(settings) << ", radius " << radius << ", tilt " << tilt << " turn " << turn
                                << " fov " << fov << ", " << place(d, rendering.frame);
          }
      }
    }
}

/// A floor, a wall, a ball on the floor, and sky.
Rendering furnished(int width = 120, int height = 90) {
  const Scene scene{{test::parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}),
                     test::parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
                     Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
  return test::render(scene, Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, 55, width, height));
}

TEST(EveryVariant, agrees_with_its_slow_version) {
  const Rendering rendering = furnished();
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < rendering.hits.size(); i += 37) some.push_back(i);
  for (EstimatorSettings settings : all_variants(0.5)) {
    settings.slices = 16;
    settings.steps = 64;
    settings.samples = 64;
    const std::vector<float> ao = run(rendering.frame, settings),
                             slow = reference_estimate(rendering.frame, settings, some);
    double bias = 0, rmse = 0;
    for (const std::size_t i : some)
      bias += (ao[i] - slow[i]) / double(some.size()), rmse += std::pow(ao[i] - slow[i], 2) / double(some.size());
    EXPECT_LE(std::abs(bias), 0.003) << name_of(settings);
    // crytek: the noise of 64 samples
    EXPECT_LE(std::sqrt(rmse), settings.estimator == Estimator::hbao ? 0.015 : 0.04) << name_of(settings);
  }
}

TEST(EveryVariant, gives_the_same_bits_twice_and_at_every_scale) {
  const Rendering rendering = furnished();
  for (const auto& settings : all_variants(0.5)) {
    const std::vector<float> once = run(rendering.frame, settings);
    EXPECT_TRUE(same_bits(run(rendering.frame, settings), once)) << name_of(settings);
    HostFrame scaled = rendering.frame;
    for (float& z : scaled.depth) z = std::ldexp(z, 10);
    scaled.sky = std::ldexp(scaled.sky, 10);
    EstimatorSettings scaled_settings = settings;
    scaled_settings.radius = std::ldexp(*settings.radius, 10);
    EXPECT_TRUE(same_bits(run(scaled, scaled_settings), once)) << name_of(settings);
  }
}

TEST(EveryVariant, gives_an_ao_from_0_to_1_on_any_bits_and_sizes) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {9, 7}, {64, 48}}) {
    HostFrame frame = furnished(width, height).frame, noisy = frame;
    std::mt19937 random(11);
    for (float& z : noisy.depth) z = std::bit_cast<float>(std::uint32_t(random()));
    for (float& n : noisy.normal) n = std::bit_cast<float>(std::uint32_t(random()));
    for (const double radius : {1e-4, 0.6, 1e3})
      for (const auto& settings : all_variants(radius))
        for (const auto* of : {&frame, &noisy})
          for (const float ao : run(*of, settings)) ASSERT_TRUE(ao >= 0 && ao <= 1) << ao << " " << name_of(settings);
  }
}

}  // namespace
}  // namespace alcove
