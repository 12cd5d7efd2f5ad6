// The exact search: what its outlines leave out, closed forms, the CPU reference, crops, and what it refuses.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/formats/exr.h"
#include "core/reference/reference.h"
#include "core/run/resume.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/long_tests.h"
#include "tests/support/scenes.h"

namespace alcove {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
const Plane kFloor{.point = {}, .normal = {0, 0, 1}}, kWallX{.point = {}, .normal = {1, 0, 0}},
    kWallY{.point = {}, .normal = {0, 1, 0}};

EstimatorSettings settings_of(double radius, SliceSearch search = SliceSearch::exact, int slices = 16) {
  EstimatorSettings settings = plain_settings();
  settings.radius = radius;
  settings.slices = slices;
  settings.search = search;
  settings.thickness = ThicknessKind::automatic;
  return settings;
}

/// As the preset `reference`.
EstimatorSettings shared_directions(double radius) {
  EstimatorSettings settings = settings_of(radius, SliceSearch::exact, 4);
  settings.denoise = Denoise::bilateral;
  settings.denoise_kernel = {1, 0.5};
  return settings;
}

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

/// Floor, wall, ball, a slab in the air, thin posts, and sky.
Rendering furnished(bool orthographic = false, int width = 160, int height = 120) {
  Scene scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
               Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5},
               parallelogram({2, -1.5, 0.3}, {0.6, 0.2, 0.1}, {0, 0.9, 0})}};
  for (int i = 0; i < 6; i++)
    scene.primitives.emplace_back(parallelogram({2.5, 0.2 + 0.15 * i, 0}, {0, 0.03, 0}, {0, 0, 0.6}));
  return render(scene, orthographic ? Shot::orthographic({4.5, -1.5, 2.4}, {1, 0, 0.6}, 4, width, height)
                                    : Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, 55, width, height));
}

TEST(Exact, outlines_give_what_every_pixel_gives) {
  for (const bool orthographic : {false, true}) {
    const HostFrame frame = furnished(orthographic).frame;
    for (const double radius : {0.3, 1.0, 100.0}) {
      for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant}) {
        for (const auto complete : {Completion::none, Completion::border, Completion::all}) {
          if (!tried(orthographic + (radius == 1) + int(thickness) + int(complete), 4)) continue;
          EstimatorSettings exact = settings_of(radius), march = settings_of(radius, SliceSearch::every_pixel);
          exact.thickness = march.thickness = thickness;
          exact.thickness_length = march.thickness_length = 0.2;
          exact.complete = march.complete = complete;
          const std::vector<float> marched = run(frame, march);
          const Difference d = difference(run(frame, exact), [&](std::size_t i) { return marched[i]; });
          // How a surface goes on, two vertices say: of outlines these are far apart, and what a pixel leaves of the
          // straight line counts the more the farther it goes on.
          const bool goes_on = complete == Completion::all && thickness != ThicknessKind::infinite;
          EXPECT_LE(d.rmse, goes_on ? 0.006 : 0.003)
              << orthographic << ", radius " << radius << ", thickness " << int(thickness) << ", complete "
              << int(complete) << ", " << place(d, frame);
          EXPECT_LE(std::abs(d.bias), complete != Completion::none ? 0.001 : 0.0005)
              << orthographic << ", radius " << radius << ", thickness " << int(thickness) << ", complete "
              << int(complete);
        }
      }
    }
  }
}

TEST(Exact, is_what_the_reference_computes) {
  for (const bool orthographic : {false, true}) {
    const HostFrame frame = furnished(orthographic).frame;
    for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant}) {
      EstimatorSettings settings = settings_of(0.6);
      settings.thickness = thickness;
      settings.thickness_length = 0.2;
      ReferenceSettings some = reference_settings_of(settings);
      for (std::size_t i = 0; i < frame.depth.size(); i += 7) some.pixels.push_back(i);
      const std::vector<float> reference = reference_ao(frame, some), ao = run(frame, settings);
      std::vector<float> compared;
      for (const std::size_t i : some.pixels) compared.push_back(ao[i]);
      const Difference d = difference(compared, [&](std::size_t i) { return reference[some.pixels[i]]; });
      EXPECT_LE(d.mean, 0.01) << orthographic << ", thickness " << int(thickness) << ", pixel " << some.pixels[d.worst];
      EXPECT_LE(std::abs(d.bias), 0.003) << orthographic << ", thickness " << int(thickness);
    }
  }
}

TEST(Exact, planes_are_open_at_every_tilt) {
  for (const double tilt : {0.0, 30.0, 60.0, 80.0, 88.0}) {
    for (const double turn : {0.0, 25.0, 90.0}) {
      const double a = tilt * kPi / 180, b = turn * kPi / 180;
      const Plane plane{.point = {5, 0, 0},
                        .normal = {-std::cos(a), std::sin(a) * std::cos(b), std::sin(a) * std::sin(b)}};
      const Rendering rendering = render({{plane}}, Shot::perspective({0, 0, 0}, {1, 0, 0}, 60, 96, 64));
      for (const auto& settings : {settings_of(0.5), shared_directions(0.5), settings_of(50)}) {
        std::vector<float> ao = run(rendering.frame, settings);
        for (int i = 0; i < int(ao.size()); i++) {
          const int x = i % 96, y = i / 96;
          // At the horizon, and where it meets the border, nothing tells a plane from an edge.
          if (tilt >= 60 && (x < 4 || y < 4 || x >= 92 || y >= 60 || rendering.primitives_within(2, x, y) > 1))
            ao[std::size_t(i)] = 1;
        }
        const Difference d = difference(ao, [](std::size_t) { return 1.0; });
        EXPECT_LE(d.max, 1e-3) << tilt << " turned by " << turn << ", radius " << *settings.radius << ", "
                               << place(d, rendering.frame);
      }
    }
  }
}

using Truth = std::function<std::optional<double>(const Hit&)>;

/// Compares the AO of every pixel that has a truth and is not beside an edge.
void expect_truth(const char* what, const Rendering& rendering, const EstimatorSettings& settings, const Truth& truth,
                  int least_pixels) {
  const std::vector<float> ao = run(rendering.frame, settings);
  double sum = 0, worst = 0;
  int pixels = 0;
  for (int y = 0; y < rendering.shot.data.height; y++) {
    for (int x = 0; x < rendering.shot.data.width; x++) {
      const Hit& hit = rendering.at(x, y);
      if (hit.primitive < 0 || rendering.primitives_within(2, x, y) > 1 ||
          16 * rendering.footprint(x, y) > *settings.radius)
        continue;
      const auto expected = truth(hit);
      if (!expected) continue;
      const double error = std::abs(ao[std::size_t(y * rendering.shot.data.width + x)] - *expected);
      sum += error;
      worst = std::max(worst, error);
      pixels++;
    }
  }
  EXPECT_GE(pixels, least_pixels) << what;
  EXPECT_LE(sum / pixels, 0.004) << what;
  EXPECT_LE(worst, 0.02) << what;
}

/// How far the AO of the pixels that have a truth and are not beside an edge is from that, on the mean.
double mean_error(const Rendering& rendering, const EstimatorSettings& settings, const Truth& truth) {
  const std::vector<float> ao = run(rendering.frame, settings);
  double sum = 0;
  int pixels = 0;
  for (int y = 0; y < rendering.shot.data.height; y++) {
    for (int x = 0; x < rendering.shot.data.width; x++) {
      const Hit& hit = rendering.at(x, y);
      if (hit.primitive < 0 || rendering.primitives_within(2, x, y) > 1) continue;
      const auto expected = truth(hit);
      if (!expected) continue;
      sum += std::abs(ao[std::size_t(y * rendering.shot.data.width + x)] - *expected);
      pixels++;
    }
  }
  EXPECT_GT(pixels, 500);
  return sum / pixels;
}

/// Area of the segment of the unit disk beyond the chord at x.
double segment(double x) { return x >= 1 ? 0 : std::acos(x) - x * std::sqrt(1 - x * x); }

TEST(Exact, wall_at_hard_radius) {
  const std::pair<const char*, Shot> views[] = {
      {"bisector", Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 60, 240, 180)},
      {"along", Shot::perspective({2, -4, 2.5}, {0.4, 0, 0.3}, 70, 240, 180)},
      {"wide", Shot::perspective({2.2, -0.6, 1.8}, {0.6, 0.2, 0.2}, 100, 320, 240)},
      {"orthographic", Shot::orthographic({4, -1, 3}, {0.5, 0, 0.5}, 5, 240, 180)}};
  for (const auto& [name, shot] : views) {
    expect_truth(
        name, render({{kFloor, kWallX}}, shot), settings_of(1),
        [&shot = shot](const Hit& hit) -> std::optional<double> {
          if (!shot.sees_ball(hit.position, 1)) return std::nullopt;
          return 1 - segment(hit.primitive == 0 ? hit.position.x : hit.position.z) / kPi;
        },
        1000);
  }
}

TEST(Exact, a_wall_goes_on_behind_a_plate) {
  // The plate stands farther than the radius before what it hides, so it blocks nothing.
  const Polygon plate = parallelogram({2.3, -0.6, 2.1}, {0, 1.2, 0}, {-0.14, 0, 0.14});
  for (const Shot& shot : {Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 50, 240, 180),
                           Shot::orthographic({4, 0, 4}, {0.5, 0, 0.5}, 5, 240, 180)}) {
    const Rendering rendering = render({{kFloor, kWallX, plate}}, shot);
    const auto truth = [&](const Hit& hit) -> std::optional<double> {
      if (hit.primitive > 1 || std::abs(hit.position.y) > 0.8 || !shot.sees_ball(hit.position, 1)) return std::nullopt;
      return 1 - segment(hit.primitive == 0 ? hit.position.x : hit.position.z) / kPi;
    };
    EstimatorSettings settings = settings_of(1);
    const double all = mean_error(rendering, settings, truth);
    settings.complete = Completion::none;
    const double none = mean_error(rendering, settings, truth);
    EXPECT_LE(all, 0.004) << none;
    EXPECT_GE(none, 3 * all);
  }
}

TEST(Exact, a_wall_goes_on_beyond_the_border) {
  const Rendering rendering = render({{kFloor, kWallX}}, Shot::perspective({3, 0, 1}, {0.15, 0, 0.1}, 70, 360, 60));
  const auto truth = [](const Hit& hit) -> std::optional<double> {
    if (std::abs(hit.position.y) > 0.7) return std::nullopt;
    return 1 - segment(hit.primitive == 0 ? hit.position.x : hit.position.z) / kPi;
  };
  EstimatorSettings settings = settings_of(1);
  settings.complete = Completion::none;
  const double none = mean_error(rendering, settings, truth);
  for (const Completion complete : {Completion::border, Completion::all}) {
    settings.complete = complete;
    EXPECT_LE(mean_error(rendering, settings, truth), 0.25 * none) << none;
  }
}

TEST(Exact, a_thing_alone_before_the_sky_is_not_completed) {
  const Scene scene{
      {Sphere{.center = {0, 0, 0}, .radius = 1}, parallelogram({1.2, -0.5, -0.5}, {0.3, 0, 0}, {0, 0, 1})}};
  const HostFrame frame = render(scene, Shot::perspective({0.3, -6, 0.5}, {0, 0, 0}, 40, 160, 120)).frame;
  EstimatorSettings settings = settings_of(1);
  settings.thickness = ThicknessKind::constant;
  settings.thickness_length = 0.2;
  const std::vector<float> all = run(frame, settings);
  settings.complete = Completion::none;
  EXPECT_TRUE(same_bits(all, run(frame, settings)));
}

TEST(Exact, completed_surfaces_take_what_is_blocked_with_them_and_not_without) {
  const HostFrame frame = furnished().frame;
  OutputSettings output;
  output.stats = "stats.json";
  for (const double tolerance : {0.0, 0.001}) {
    EstimatorSettings settings = settings_of(0.6);
    settings.slices = 64;
    settings.tolerance = tolerance;
    settings.thickness = ThicknessKind::constant;
    settings.thickness_length = 0.2;
    const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
    recorder().download(*outputs.completed);
    recorder().run();
    const auto taken = outputs.completed->as<const float>();
    const std::vector<float> completed(taken.begin(), taken.end());
    const auto with = outputs.ao->as<const float>();
    const std::vector<float> all(with.begin(), with.end());
    settings.complete = Completion::none;
    const std::vector<float> none = run(frame, settings);
    const Difference d = difference(completed, [&](std::size_t i) { return none[i] - all[i]; });
    EXPECT_LE(d.rmse, tolerance > 0 ? 0.002 : 1e-3) << tolerance << ", " << place(d, frame);
    EXPECT_GT(*std::ranges::max_element(completed), 0.05);
  }
}

/// Beside two walls at a right angle, at these distances in radii.
double beside_two_walls(double a, double b) {
  if (a >= 1 || b >= 1) return 1 - (segment(a) + segment(b)) / kPi;
  const auto area = [](double x) { return 0.5 * (x * std::sqrt(1 - x * x) + std::asin(x)); };
  const double far = std::sqrt(1 - b * b), both = a >= far ? 0 : area(far) - area(a) - b * (far - a);
  return 1 - (segment(a) + segment(b) - both) / kPi;
}

TEST(Exact, corner_at_hard_radius) {
  const std::pair<const char*, Shot> views[] = {
      {"diagonal", Shot::perspective({4, 4, 4}, {0.5, 0.5, 0.5}, 50, 240, 200)},
      {"wide", Shot::perspective({2, 2.4, 1.8}, {0.6, 0.2, 0.4}, 100, 320, 240)}};
  for (const auto& [name, shot] : views) {
    expect_truth(
        name, render({{kFloor, kWallX, kWallY}}, shot), settings_of(1),
        [&shot = shot](const Hit& hit) -> std::optional<double> {
          if (!shot.sees_ball(hit.position, 1)) return std::nullopt;
          const auto [x, y, z] = hit.position;
          return hit.primitive == 0   ? beside_two_walls(x, y)
                 : hit.primitive == 1 ? beside_two_walls(y, z)
                                      : beside_two_walls(x, z);
        },
        1000);
  }
}

TEST(Exact, spherical_bowl) {
  const double cosine = 0.5, rim = std::sqrt(0.75);
  const Sphere bowl{.center = {0, 0, 0}, .radius = 1, .axis = {0, 0, -1}, .cos_half_angle = cosine};
  const Plane ground{.point = {0, 0, -cosine}, .normal = {0, 0, 1}, .hole = rim};
  for (const auto& settings : {settings_of(1000), shared_directions(1000)})
    expect_truth(
        "bowl", render({{bowl, ground}}, Shot::perspective({0.1, -0.2, 1}, {0, 0, -0.7}, 90, 240, 240)), settings,
        [&](const Hit& hit) { return hit.primitive == 0 ? std::optional((1 + cosine) / 2) : std::nullopt; }, 1000);
}

TEST(Exact, directions_shared_by_a_block_come_close_to_all_of_them) {
  const HostFrame frame = furnished().frame;
  const std::vector<float> all = run(frame, settings_of(0.6));
  const Difference d = difference(run(frame, shared_directions(0.6)), [&](std::size_t i) { return all[i]; });
  EXPECT_LE(d.mean, 0.01) << place(d, frame);
  EXPECT_LE(std::abs(d.bias), 0.002);
}

// A block whose pixels did not all have their share would keep what the frame before has left in its buffers.
TEST(Exact, directions_are_shared_by_all_pixels_of_a_block) {
  const HostFrame other = furnished(true).frame;
  for (const double stretch : {1.0, 1.5}) {
    HostFrame frame = furnished().frame;
    frame.camera.fy *= stretch;  // so that other directions go along columns
    const std::vector<float> all = run(frame, settings_of(0.6));
    for (int slices = 1; slices <= 8; slices++) {
      EstimatorSettings settings = shared_directions(0.6);
      settings.slices = slices;
      const std::vector<float> ao = run(frame, settings);
      run(other, settings);
      EXPECT_TRUE(same_bits(ao, run(frame, settings))) << slices << " slices, pixels stretched by " << stretch;
      EXPECT_LE(difference(ao, all).mean, 0.02) << slices << " slices, pixels stretched by " << stretch;
    }
  }
}

TEST(Exact, the_mirrored_frame_has_the_mirrored_ao) {
  HostFrame frame = furnished().frame;
  const auto mirrored = [&](std::vector<float> plane) {
    for (auto row = plane.begin(); row != plane.end(); row += frame.data.width)
      std::reverse(row, row + frame.data.width);
    return plane;
  };
  const std::vector<float> expected = mirrored(run(frame, settings_of(0.6)));
  frame.camera.cx = frame.display.width - frame.camera.cx;
  frame.depth = mirrored(frame.depth);
  frame.normal = mirrored(frame.normal);
  for (std::size_t i = 0; i < frame.data.pixels(); i++) frame.normal[i] *= -1;
  const Difference d = difference(run(frame, settings_of(0.6)), [&](std::size_t i) { return expected[i]; });
  EXPECT_LE(d.rmse, 0.005) << place(d, frame);
}

TEST(Exact, twice_gives_the_same_bits_and_sky_is_open) {
  const Rendering rendering = furnished();
  const std::vector<float> ao = run(rendering.frame, shared_directions(0.6));
  EXPECT_TRUE(same_bits(ao, run(rendering.frame, shared_directions(0.6))));
  for (std::size_t i = 0; i < ao.size(); i++)
    if (rendering.hits[i].primitive < 0) EXPECT_EQ(ao[i], 1);
}

TEST(Exact, any_shape_of_frame_is_searched) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {3, 700}, {700, 3}}) {
    const HostFrame frame = furnished(false, width, height).frame;
    for (const float value : run(frame, settings_of(0.6)))
      ASSERT_TRUE(value >= 0 && value <= 1) << width << " x " << height;
  }
}

TEST_F(CommandLine, an_exact_search_of_a_region_is_that_part_of_the_whole) {
  const Window data{-8, -4, 1000, 400}, display{0, 0, 990, 390}, region{319, 114, 127, 60};
  FrameFile rough = wall_frame(data, display);
  std::vector<float>& depth = rough.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) {
    const auto x = i % std::size_t(data.width), y = i / std::size_t(data.width);
    depth[i] *= float(1 + 0.002 * std::sin(0.1 * double(x)) * std::sin(0.07 * double(y)) -
                      ((x / 40 * 7 + y / 25 * 3) % 5 == 0 ? 0.01 : 0));
  }
  rough.write(frame);
  write_bytes(camera, wall_camera(display).dump());
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--preset", "reference"},
                                               {"--search", "exact", "--slices", "2"},
                                               {"--tolerance", "0.05"},
                                               {"--search", "exact", "--resolution", "half"}}) {
    std::vector<std::string> arguments{"run",      frame,  "-o",     ao,
                                       "--camera", camera, "--type", "float",
                                       "--radius", "0.1",  "--aov",  "ao,bent-normal,specular-occlusion"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_EQ(run_program(arguments).code, 0);
    const Image whole = read_exr_image(ao);
    EXPECT_LT(std::ranges::min(whole.plane("Y")), 0.8);
    arguments.insert(arguments.end(), {"--roi", "319,114,127,60"});
    ASSERT_EQ(run_program(arguments).code, 0);
    const Image part = read_exr_image(ao);
    for (const char* name : {"Y", "bent.X", "bent.Y", "bent.Z", "specular.Y"}) {
      const auto values = whole.plane(name);
      const auto found = part.plane(name);
      EXPECT_TRUE(same_bits({found.begin(), found.end()}, cropped({values.begin(), values.end()}, whole.data, region)))
          << testing::PrintToString(more) << " " << name;
    }
  }
}

TEST_F(CommandLine, a_surface_goes_on_into_a_region_from_far_beyond_its_reach) {
  const Window data{0, 0, 1000, 300}, region{440, 60, 30, 30};
  // Left of a bar the wall is at 6, right of it at 5.8, and that goes on behind the bar.
  FrameFile barred = wall_frame(data, data);
  std::vector<float>& depth = barred.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) {
    const auto x = i % std::size_t(data.width);
    if (x >= 480) depth[i] *= float(x < 680 ? 4.8 / 6 : 5.8 / 6);
  }
  barred.write(frame);
  write_bytes(camera, wall_camera(data).dump());
  std::vector<std::string> arguments{"run",    frame,   "-o",       ao,    "--camera", camera,
                                     "--type", "float", "--radius", "0.5", "--preset", "reference"};
  ASSERT_EQ(run_program(arguments).code, 0);
  const Image whole = read_exr_image(ao);
  const std::vector<float> part = cropped(whole.pixels, whole.data, region);
  arguments.insert(arguments.end(), {"--set", "complete=border"});
  ASSERT_EQ(run_program(arguments).code, 0);
  EXPECT_FALSE(same_bits(read_exr_image(ao).pixels, whole.pixels));
  arguments.back() = "complete=all";
  arguments.insert(arguments.end(), {"--roi", "440,60,30,30"});
  ASSERT_EQ(run_program(arguments).code, 0);
  EXPECT_TRUE(same_bits(read_exr_image(ao).pixels, part));
}

TEST_F(CommandLine, an_exact_search_refuses_what_it_cannot_do) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {{{"--falloff", "linear"}, "--falloff"},
                                                                    {{"--set", "stride=4"}, "--set stride"}};
  for (const auto& [more, named] : cases) {
    std::vector<std::string> options{"--search", "exact"};
    options.insert(options.end(), more.begin(), more.end());
    const Finished finished = test::CommandLine::run(options);
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err, testing::AllOf(HasSubstr(named), HasSubstr("--search steps")));
  }
}

TEST(Exact, the_search_is_in_the_digest) {
  Settings settings;
  settings.estimator.radius = 1;
  const std::string plain = options_digest(settings);
  settings.estimator.search = SliceSearch::exact;
  EXPECT_NE(options_digest(settings), plain);
}

}  // namespace
}  // namespace alcove
