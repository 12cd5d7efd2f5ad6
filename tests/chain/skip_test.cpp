// What is left out because a proof says so has the bits of what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "core/base/estimator_facts.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/long_tests.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using namespace test;

struct Outcome {
  std::vector<float> values;  // AO of all scales, and the bent normals
  TileCounts tiles{};
};

Outcome run(const HostFrame& frame, EstimatorSettings settings, bool no_skip) {
  settings.no_skip = no_skip;
  OutputSettings output;
  output.aovs = searches_slices(settings) ? "ao,bent-normal,ao-scales" : "ao,ao-scales";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  recorder().run();
  Outcome outcome;
  for (const auto* planes : {outputs.ao, outputs.scales, outputs.bent_normal}) {
    if (!planes) continue;
    const auto values = planes->as<float>();
    outcome.values.insert(outcome.values.end(), values.begin(), values.end());
  }
  outcome.tiles = outputs.tiles->as<TileCounts>()[0];
  return outcome;
}

/// So many samples that proofs are worth their cost.
EstimatorSettings proving(Estimator estimator, double radius, ThicknessKind thickness = ThicknessKind::automatic) {
  EstimatorSettings settings = plain_settings();
  settings.estimator = estimator;
  settings.radius = radius;
  settings.thickness = thickness;
  settings.thickness_length = radius / 4;
  settings.slices = 3;
  settings.steps = 8;
  settings.samples = 64;
  EXPECT_TRUE(proves(settings));
  return settings;
}

/// Returns what became of the tiles.
TileCounts expect_same(const HostFrame& frame, const EstimatorSettings& settings, const std::string& what) {
  const Outcome skipped = run(frame, settings, false), whole = run(frame, settings, true);
  EXPECT_EQ(whole.tiles.sky + whole.tiles.open, 0u) << what;
  EXPECT_EQ(skipped.tiles.sky + skipped.tiles.open + skipped.tiles.listed, whole.tiles.listed) << what;
  EXPECT_TRUE(same_bits(skipped.values, whole.values)) << what;
  return skipped.tiles;
}

TEST(Skip, a_floor_is_open_but_where_something_stands_on_it) {
  const Scene scene{
      {parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}), Sphere{.center = {0, 0, 0.2}, .radius = 0.2}}};
  const Rendering floor = render(scene, Shot::perspective({0, -3, 2}, {0, 0, 0}, 50, 160, 120));
  for (const Estimator estimator : kEstimators) {
    const auto proved =
        expect_same(floor.frame, proving(estimator, 0.3), "estimator " + std::to_string(int(estimator))).open;
    EXPECT_GT(proved, 100u) << "of 300, estimator " << int(estimator);
    EXPECT_LT(proved, 295u);
  }
}

TEST(Skip, thicknesses_falloffs_scales_strides_and_resolutions) {
  const Rendering room = furnished_room(157, 119);
  for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant})
    for (const auto falloff : {Falloff::none, Falloff::smooth}) {
      EstimatorSettings settings = proving(Estimator::gtao, 0.4, thickness);
      settings.falloff = falloff;
      expect_same(room.frame, settings, "thickness " + std::to_string(int(thickness)));
    }
  EstimatorSettings settings = proving(Estimator::gtao, 0.4);
  settings.further_radii = {0.1, 0.02};
  expect_same(room.frame, settings, "scales");
  settings = proving(Estimator::gtao, 0.4);
  settings.denoise = Denoise::bilateral;
  settings.steps = 256;
  for (const Density density : {Density::uniform, Density::adaptive})
    for (const int stride : {2, 4, 8, 16}) {
      settings.density = density;
      settings.stride = stride;
      ASSERT_TRUE(proves(settings));
      const std::string what = fmt::format("stride {}, density {}", stride, int(density));
      EXPECT_GT(expect_same(room.frame, settings, what).open, 0u) << what;
    }
  settings.stride = 1;
  settings.steps = 128;
  for (const auto resolution : {Resolution::half, Resolution::quarter}) {
    settings.resolution = resolution;
    expect_same(room.frame, settings, "resolution " + std::to_string(int(resolution)));
  }
}

TEST(Skip, sky_is_left_out_whatever_the_samples_cost) {
  HostFrame frame = furnished_room(160, 120).frame;
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.3;
  settings.slices = settings.steps = 2;
  ASSERT_FALSE(proves(settings));
  expect_same(frame, settings, "few samples");
  std::ranges::fill(frame.depth, kSky);
  const Outcome sky = run(frame, settings, false);
  EXPECT_EQ(sky.tiles.listed, 0u);
  EXPECT_EQ(sky.tiles.sky, 300u);
  for (std::size_t i = 0; i < frame.data.pixels(); i++) ASSERT_EQ(sky.values[i], 1.0f);
}

// An estimate by its error leaves out sky by itself; beside it stand the estimates of confidence, and a frame of sky.
TEST(Skip, estimates_by_their_error) {
  HostFrame frame = furnished_room(80, 60).frame;
  EstimatorSettings settings;
  settings.radius = 0.3;
  settings.slices = 3;
  settings.tolerance = 0.05;
  OutputSettings output;
  const auto planes = [&](bool no_skip) {
    settings.no_skip = no_skip;
    const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
    recorder().run();
    std::vector<float> values;
    for (const auto* plane : {outputs.ao, outputs.scales, outputs.error, outputs.confidence})
      if (plane) values.insert(values.end(), plane->as<float>().begin(), plane->as<float>().end());
    return values;
  };
  for (const bool is_sky : {false, true}) {
    if (is_sky) std::ranges::fill(frame.depth, kSky);
    for (const std::string aovs : {"ao,ao-scales", "ao,error,confidence"}) {
      output.aovs = aovs;
      const std::vector<float> skipped = planes(false);
      EXPECT_EQ(recorder().passes().empty(), is_sky && aovs == "ao,ao-scales") << aovs;
      EXPECT_TRUE(same_bits(skipped, planes(true))) << aovs << (is_sky ? " of sky" : "");
    }
  }
}

TEST(Skip, a_frame_of_sky_needs_no_kernel) {
  HostFrame frame = furnished_room(70, 50).frame;
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.3;
  settings.further_radii = {0.1};
  settings.power = 1.4;
  settings.denoise = Denoise::bilateral;
  for (const auto resolution : {Resolution::full, Resolution::quarter}) {
    settings.resolution = resolution;
    for (const float sky : {0.0f, 1e9f, std::numeric_limits<float>::infinity()}) {
      std::ranges::fill(frame.depth, sky);
      const HostResult skipped = compute_ao(recorder(), frame, settings);
      EXPECT_TRUE(recorder().passes().empty());
      settings.no_skip = true;
      const HostResult whole = compute_ao(recorder(), frame, settings);
      settings.no_skip = false;
      EXPECT_FALSE(recorder().passes().empty());
      EXPECT_TRUE(same_bits(skipped.ao, whole.ao));
      EXPECT_EQ(skipped.sky_pixels, whole.sky_pixels);
    }
    for (const float other : {std::numeric_limits<float>::quiet_NaN(), -1.0f, 5.0f}) {
      frame.depth[1234] = other;
      const HostResult result = compute_ao(recorder(), frame, settings);
      EXPECT_FALSE(recorder().passes().empty()) << other;
      EXPECT_EQ(result.sky_pixels, other > 0 ? 3499u : 3500u);
      EXPECT_EQ(result.repaired_depth, other > 0 ? 0u : 1u);
    }
  }
}

// A floor seen aslant stands above the tangent plane of a receiver whose normal is turned a little, however flat it is.
TEST(Skip, receivers_whose_normals_differ_a_little) {
  for (const double tilt : {70.0, 80.0, 86.0}) {
    const double t = tilt * std::numbers::pi / 180;
    const Plane floor{.point = {5, 0, 0}, .normal = {-std::cos(t), 0, std::sin(t)}};
    HostFrame frame = render({{floor}}, Shot::perspective({}, {1, 0, 0}, 12, 160, 120)).frame;
    const std::size_t pixels = frame.data.pixels();
    for (std::size_t i = 0; i < pixels; i++) {
      const bool is_central = i % 160 % kTile == kTile / 2 && i / 160 % kTile == kTile / 2;
      const double turn = is_central ? 0 : 1.9e-3 * double(i * 2654435761u % 1000) / 1000;
      const double n[] = {frame.normal[i], frame.normal[i + pixels], frame.normal[i + 2 * pixels]};
      frame.normal[i + pixels] = float(n[1] * std::cos(turn) - n[2] * std::sin(turn));  // about the horizontal axis
      frame.normal[i + 2 * pixels] = float(n[1] * std::sin(turn) + n[2] * std::cos(turn));
    }
    for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask, Estimator::hbao}) {
      const std::string what = fmt::format("estimator {} tilt {}", int(estimator), tilt);
      EstimatorSettings settings = proving(estimator, 2);
      expect_same(frame, settings, what);
      const auto values = run(frame, settings, true).values;
      EXPECT_TRUE(estimator == Estimator::hbao || std::ranges::any_of(values, [](float x) { return x < 1; }))
          << what << ": or else all is open, and nothing proved";
    }
  }
}

TEST(Skip, any_bits_as_input) {
  for (unsigned seed = 0; seed < 60; seed++) {
    const int width = 1 + int(seed * 7 % 90), height = 1 + int(seed * 13 % 50);
    const HostFrame frame = random_bits(width, height, seed);
    for (const Estimator estimator : kEstimators) {
      EstimatorSettings settings = proving(estimator, 0.5);
      settings.denoise = seed % 2 ? Denoise::bilateral : Denoise::none;
      expect_same(frame, settings, "seed " + std::to_string(seed));
    }
  }
}

// At a radius that suits the frame few tiles are open, and proofs tell in which directions to look; at a small one some
// are. Within reach of the border fewer are proved where surfaces go on beyond it.
TEST(Skip, rendered_frames) {
  for (const auto& [scene, radius, small] : {std::tuple<std::string, double, double>("monkeys", 0.5, 0.02),
                                             {"colonnade", 0.75, 0.1},
                                             {"machine", 0.006, 0.003}}) {
    InputSettings input;
    input.input = ALCOVE_SOURCE_DIR "/examples/bench/" + scene + ".gbuffer.exr";
    input.camera = ALCOVE_SOURCE_DIR "/examples/bench/" + scene + ".camera.json";
    const HostFrame frame = read_host_frame(input, 0);
    for (const Estimator estimator : kEstimators) {
      const std::string what = scene + ", estimator " + std::to_string(int(estimator));
      for (const Completion complete : {Completion::none, Completion::all}) {
        EstimatorSettings settings = proving(estimator, radius);
        settings.complete = complete;
        expect_same(frame, settings, what);
        settings = proving(estimator, small);
        settings.complete = complete;
        const std::uint32_t open = expect_same(frame, settings, what + ", small radius").open;
        EXPECT_GE(open, complete == Completion::none ? 4u : 2u) << what;
      }
    }
  }
}

/// A flat ground of radius 1, and around it one that lies so much higher.
Scene pit(double depth) {
  constexpr int kSides = 24;
  const auto around = [](int i, double radius, double height) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    return Vec3{radius * std::cos(angle), radius * std::sin(angle), height};
  };
  Scene scene{{Plane{{0, 0, -depth}, {0, 0, 1}}}};
  for (int i = 0; i < kSides; i++) {
    scene.primitives.push_back(Polygon{{around(i, 1, 0), around(i + 1, 1, 0), around(i + 1, 9, 0), around(i, 9, 0)}});
    scene.primitives.push_back(
        Polygon{{around(i, 1, 0), around(i + 1, 1, 0), around(i + 1, 1, -depth), around(i, 1, -depth)}});
  }
  return scene;
}

// What rises by the border may go on beyond it, so that within its reach nothing is tolerated: in these pictures, which
// are two radii wide, nowhere.
TEST(Skip, a_tolerance_takes_no_more_than_it_says) {
  const Shot shots[] = {Shot::perspective({0, 0, 3}, {0.01, 0, 0}, 50, 240, 240),
                        Shot::perspective({0, -1.5, 2}, {0, 0, 0}, 60, 240, 200),
                        Shot::orthographic({0, -1, 4}, {0, 0, 0}, 2.6, 240, 240)};
  for (const Shot& shot : shots)
    for (const auto& [tolerance, complete] : {std::pair(1.0 / 1024, Completion::none),
                                              {1.0 / 1024, Completion::all},
                                              {0.01, Completion::none},
                                              {0.01, Completion::all}}) {
      std::uint32_t open = 0, proved = 0;
      // In the middle the edge takes depth^2.
      for (const double share : {0.05, 0.3, 1.3}) {
        const HostFrame frame = render(pit(std::sqrt(share * tolerance)), shot).frame;
        EstimatorSettings settings = proving(Estimator::gtao, 1.5, ThicknessKind::infinite);
        settings.slices = 4;
        settings.steps = 24;
        settings.complete = complete;
        const Outcome exact = run(frame, settings, false);
        settings.skip_tolerance = tolerance;
        const Outcome tolerant = run(frame, settings, false);
        double worst = 0;
        for (std::size_t k = 0; k < frame.data.pixels(); k++)
          worst = std::max(worst, double(std::abs(tolerant.values[k] - exact.values[k])));
        EXPECT_LE(worst, tolerance) << "tolerance " << tolerance << ", share " << share;
        open += tolerant.tiles.open;
        proved += exact.tiles.open;
      }
      if (complete == Completion::none) EXPECT_GT(open, proved) << "tolerance " << tolerance;
    }
}

/// How many times as large as usual a random scene's picture is. Usual ones are two or three groups of tiles wide,
/// where hardly any group is far: every third is so large that proofs search far groups too.
int size_of(int scene) { return scene % 3 == 2 ? 3 : 1; }

// ALCOVE_TEST_SEED: other scenes.
unsigned seed_or(unsigned usual) {
  const char* seed = std::getenv("ALCOVE_TEST_SEED");
  return seed ? unsigned(std::atoi(seed)) : usual;
}

/// Any settings with so many samples that proofs are worth their cost: the presets', with more steps. What is compiled
/// for them alone is as few as will do. Scene after scene, estimators, thicknesses and presets take turns, so that 48
/// scenes have all of their combinations.
EstimatorSettings any_proving(RandomScenes& random, int scene) {
  const auto one_of = [&](auto... values) {
    return std::array{values...}[std::size_t(random.whole(0, int(sizeof...(values)) - 1))];
  };
  EstimatorSettings settings;
  settings.estimator = kEstimators[scene % 4];
  settings.radius = random.radius();
  for (int more = random.whole(-2, 2); more > 0; more--) settings.further_radii.push_back(random.radius());
  settings.falloff = one_of(Falloff::none, Falloff::smooth);
  settings.falloff_start = one_of(0.0, 0.5);
  settings.falloff_end = one_of(1.0, 0.6);
  settings.thickness = ThicknessKind(scene / 4 % 3);
  settings.thickness_length = *settings.radius / random.whole(1, 20);
  settings.complete = Completion(random.whole(0, 2));
  settings.bias = settings.estimator == Estimator::crytek ? one_of(0.0, 0.01) : one_of(0.0, 0.0, 0.1);
  settings.elevation = one_of(Elevation::view, Elevation::surface);
  settings.sample_kernel = one_of(SampleKernel::clustered, SampleKernel::uniform);
  settings.range_check = one_of(RangeCheck::none, RangeCheck::ratio, RangeCheck::smoothstep);
  settings.samples = 64;
  std::tie(settings.slices, settings.steps, settings.stride, settings.denoise_radius) =
      std::array{std::tuple(1, 10, 0, 6), std::tuple(2, 16, 0, 4), std::tuple(3, 16, 1, 2),
                 std::tuple(2, 16, 2, 3)}[std::size_t(scene / 4 % 4)];
  if (settings.estimator != Estimator::crytek)
    settings.resolution =
        one_of(Resolution::full, Resolution::full, Resolution::full, Resolution::half, Resolution::quarter);
  settings.denoise = one_of(Denoise::none, Denoise::bilateral, Denoise::bilateral, Denoise::bilateral, Denoise::box);
  settings.denoise_depth_sigma = one_of(0.0, 0.0, 0.1);
  if (settings.stride == 2) {  // only these have it
    settings.denoise = Denoise::bilateral;
    settings.resolution = Resolution::full;
  }
  if (settings.denoise != Denoise::bilateral || settings.resolution != Resolution::full ||
      settings.estimator == Estimator::crytek)
    settings.stride = 1;
  settings.density = Density(scene / 16 % 2);
  settings.seed = unsigned(random.whole(0, 3));
  while (!proves(settings)) settings.steps *= 2;
  return settings;
}

TEST(Skip, hundreds_of_random_settings) {
  RandomScenes scenes(seed_or(20261122));
  struct Proved {
    double open = 0, all = 0;  // tiles with surfaces
  };
  std::map<std::string, Proved> proved;
  const int count = long_tests() ? 260 : 72;
  for (int i = 0; i < count && !HasFailure(); i++) {
    const EstimatorSettings settings = any_proving(scenes, i);
    HostFrame frame = scenes.next(settings.resolution == Resolution::full ? size_of(i) : 2);
    if (scenes.whole(0, 1)) {  // a crop: its blocks and its noise begin outside of it
      const int x = scenes.whole(0, 9), y = scenes.whole(0, 9);
      frame.data.x += x, frame.data.y += y, frame.camera.cx += x, frame.camera.cy += y;
    }
    const std::string estimator = "estimator " + std::to_string(int(settings.estimator)),
                      resolution = "resolution " + std::to_string(int(settings.resolution)),
                      stride = "stride " + std::to_string(spacing_of(settings)),
                      thickness = "thickness " + std::to_string(int(settings.thickness)),
                      density = is_adaptive(settings) ? "adaptive" : "uniform";
    const TileCounts tiles =
        expect_same(frame, settings,
                    fmt::format("scene {}, {}, {}, {}, {}, {}", i, estimator, resolution, stride, thickness, density));
    for (const auto& kind : {estimator, resolution, stride, thickness, density})
      proved[kind].open += tiles.open, proved[kind].all += tiles.open + tiles.listed;
  }
  EXPECT_EQ(proved.size(), 4 + 3 + 4 + 3 + 2);
  for (const auto& [kind, tiles] : proved) {
    EXPECT_GT(tiles.open, 0.04 * tiles.all) << kind;
    EXPECT_LT(tiles.open, 0.9 * tiles.all) << kind;
  }
}

// Of two estimators, and all kinds of thickness.
TEST(Skip, a_tolerance_opens_only_what_is_nearly_open) {
  RandomScenes scenes(seed_or(20261123));
  std::map<std::string, std::uint32_t> opened;
  for (int i = 0; i < 180 && !HasFailure(); i++) {
    const Estimator estimator = i % 2 ? Estimator::gtao : Estimator::bitmask;
    const ThicknessKind thickness = ThicknessKind(i / 2 % 3);
    const double tolerance = std::array{1.0 / 1024, 0.01, 0.1}[std::size_t(i / 6 % 3)];
    EstimatorSettings settings = proving(estimator, scenes.radius(), thickness);
    settings.slices = 4;
    settings.steps = 24;
    settings.complete = i / 18 % 2 ? Completion::all : Completion::none;
    if (scenes.whole(0, 3) == 0) settings.further_radii = {scenes.radius()};
    const HostFrame frame = scenes.next();
    const Outcome exact = run(frame, settings, false);
    settings.skip_tolerance = tolerance;
    const Outcome tolerant = run(frame, settings, false);
    const std::string kind =
        "estimator " + std::to_string(int(estimator)) + ", thickness " + std::to_string(int(thickness));
    const std::string what = "scene " + std::to_string(i) + ", " + kind;
    // The scales; they lie behind the AO, which is their mean.
    const std::size_t begin = frame.data.pixels(), end = begin * (2 + settings.further_radii.size());
    double least = 1;
    for (std::size_t k = begin; k < end; k++) {
      if (tolerant.values[k] == exact.values[k]) continue;
      EXPECT_EQ(tolerant.values[k], 1.0f) << what;
      least = std::min(least, double(exact.values[k]));
    }
    EXPECT_GE(least, 1 - tolerance) << what;
    opened[kind] += tolerant.tiles.open - exact.tiles.open;
  }
  EXPECT_EQ(opened.size(), 6u);
  for (const auto& [kind, tiles] : opened) EXPECT_GT(tiles, 10u) << kind;
}

void expect_same_in_random_scenes(unsigned seed, int count) {
  RandomScenes scenes(seed);
  std::uint64_t proved = 0;
  int scenes_with_proofs = 0;
  for (int i = 0; i < count && !testing::Test::HasFailure(); i++) {
    const HostFrame frame = scenes.next(size_of(i));
    const double radius = scenes.radius();
    const Estimator estimator = scenes.estimator();
    EstimatorSettings settings = proving(estimator, radius, scenes.thickness());
    settings.complete = Completion(i % 3);
    if (i % 2) {
      settings.denoise = i % 4 == 1 ? Denoise::bilateral : Denoise::box;
      settings.denoise_radius = scenes.whole(1, 8);
      settings.denoise_depth_sigma = i % 8 == 1 ? 0.1 : 0;
    }
    if (i % 16 == 5) {
      settings.density = Density(i / 16 % 2);
      settings.stride = 1 << scenes.whole(1, 4);
      settings.steps *= 2 * settings.stride;
      EXPECT_TRUE(proves(settings) || estimator == Estimator::crytek);
    }
    const auto open = expect_same(frame, settings,
                                  "scene " + std::to_string(i) + ", radius " + std::to_string(radius) + ", estimator " +
                                      std::to_string(int(estimator)))
                          .open;
    proved += open;
    scenes_with_proofs += open > 0;
  }
  EXPECT_GT(scenes_with_proofs, count / 10) << "scenes in which anything was proved";
  EXPECT_GT(proved, std::uint64_t(count)) << "tiles";
}

TEST(Skip, a_hundred_random_scenes) { expect_same_in_random_scenes(seed_or(20261121), cases_of(100)); }

TEST(Skip, thousands_of_random_scenes) { expect_same_in_random_scenes(seed_or(20261124), long_tests() ? 1900 : 200); }

}  // namespace
}  // namespace alcove
