// What goes on where the picture does not show it, in the searches that take samples: against rays and wider pictures.
// SPDX-License-Identifier: BSD-3-Clause
//
// The scenes are of flat things without thickness, and the searches are told that occluders are thin. Without completed
// surfaces they then miss exactly what is hidden.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/formats/exr.h"
#include "core/reference/reference.h"
#include "core/run/frame_run.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/hidden_truth.h"
#include "tests/support/scenes.h"

namespace alcove {
namespace {

using namespace test;

constexpr double kThin = 0.001;  // scene units
constexpr int kRaysAcross = 64;
constexpr int kEvery = 4;  // px from one receiver to the next
constexpr Estimator kSampled[] = {Estimator::gtao, Estimator::bitmask};
const Plane kFloor{.point = {}, .normal = {0, 0, 1}};
const Plane kWall{.point = {}, .normal = {1, 0, 0}};
const Scene kPlateScene{{kFloor, kWall, parallelogram({0.8, -0.5, 0.45}, {0, 1, 0}, {0, 0, 0.8})}};

EstimatorSettings thin(Estimator estimator, double radius, Completion complete) {
  EstimatorSettings settings = plain_settings();
  settings.estimator = estimator;
  settings.radius = radius;
  settings.slices = 8;
  settings.steps = 32;
  settings.thickness = ThicknessKind::constant;
  settings.thickness_length = kThin;
  settings.complete = complete;
  return settings;
}

struct Planes {
  std::vector<float> ao, scales, completed, confidence;
};

std::vector<float> values_of(const gpu::Buffer* plane) {
  if (!plane) return {};
  const auto values = plane->as<const float>();
  return {values.begin(), values.end()};
}

Planes planes_of(const HostFrame& frame, const EstimatorSettings& settings) {
  OutputSettings output;
  output.aovs = "ao,ao-scales,confidence";
  output.stats = "stats.json";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  if (outputs.completed) recorder().download(*outputs.completed);
  recorder().run();
  return {values_of(outputs.ao), values_of(outputs.scales), values_of(outputs.completed),
          values_of(outputs.confidence)};
}

std::vector<float> ao_of(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

double mean_error(const std::vector<float>& ao, const std::vector<std::size_t>& pixels,
                  const std::vector<double>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); i++) sum += std::abs(ao[pixels[i]] - truth[i]);
  return sum / double(pixels.size());
}

/// The same view with a principal point off the centre and pixels that are not square.
Shot oblique(Shot shot) {
  shot.camera.cx += 13.7;
  shot.camera.cy -= 8.3;
  shot.camera.fy *= 1.15;
  return shot;
}

/// Completed, the chosen surfaces have their true AO to the bound; without, they are at least 3 times as far off.
void expect_completed(const char* what, const Scene& scene, const Shot& shot, double radius, const Chosen& chosen,
                      double bound) {
  const Rendering rendering = render(scene, shot);
  const std::vector<std::size_t> pixels = receivers(rendering, radius, kEvery, chosen);
  ASSERT_GE(pixels.size(), 30u) << what;
  std::vector<double> truth;
  for (const std::size_t i : pixels) truth.push_back(true_ao(scene, rendering.hits[i], radius, kRaysAcross));
  for (const Estimator estimator : kSampled) {
    const double all = mean_error(ao_of(rendering.frame, thin(estimator, radius, Completion::all)), pixels, truth);
    const double none = mean_error(ao_of(rendering.frame, thin(estimator, radius, Completion::none)), pixels, truth);
    EXPECT_LE(all, bound) << what << ", estimator " << int(estimator);
    EXPECT_GE(none, 3 * all) << what << ", estimator " << int(estimator);
  }
}

TEST(Pieces, of_a_wall_go_on_behind_a_plate) {
  const Chosen floor_behind = [](const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.7; };
  expect_completed("perspective", kPlateScene, oblique(Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, 240, 180)),
                   1, floor_behind, 0.0097);
  expect_completed("orthographic", kPlateScene, Shot::orthographic({5, 0.3, 1.8}, {0.3, 0, 0.6}, 5, 240, 180), 1,
                   floor_behind, 0.0097);
}

TEST(Pieces, of_a_wall_go_on_behind_a_column) {
  const Plane other_wall{.point = {}, .normal = {0, 1, 0}};
  const Scene scene{{other_wall, kWall, parallelogram({0.75, 0.35, -9}, {-0.15, 0.15, 0}, {0, 0, 18})}};
  const Chosen beside = [](const Hit& hit) { return hit.primitive == 1 && hit.position.y < 0.6; };
  expect_completed("perspective", scene, oblique(Shot::perspective({4, 4, 1}, {0.3, 0.3, 0}, 45, 240, 180)), 0.8,
                   beside, 0.018);
  expect_completed("orthographic", scene, Shot::orthographic({4, 4, 1}, {0.3, 0.3, 0}, 4, 240, 180), 0.8, beside,
                   0.018);
}

TEST(Pieces, of_a_floor_go_on_behind_half_a_sphere) {
  const Sphere half{.center = {0.9, 0, 0.8}, .radius = 0.2, .axis = unit({2.1, 0, 2.7}), .cos_half_angle = 0.15};
  const Scene scene{{kFloor, kWall, half}};
  const Chosen low = [](const Hit& hit) { return hit.primitive == 1 && hit.position.z < 0.5; };
  expect_completed("perspective", scene, oblique(Shot::perspective({3, 0, 3.5}, {0.3, 0, 0.3}, 50, 240, 180)), 0.8, low,
                   0.0087);
  expect_completed("orthographic", scene, Shot::orthographic({3, 0, 3.5}, {0.3, 0, 0.3}, 4, 240, 180), 0.8, low,
                   0.0087);
}

// Behind the column the wall is taken to go on as far as it is hidden. So what is blocked too much, or too little, is
// no more than the receiver sees of the part of the wall's plane that the column hides: of that without wall, or with
// it.
TEST(Pieces, of_a_wall_that_ends_behind_a_column_err_by_what_it_hides_at_most) {
  const Vec3 eye{5, 0.2, 1.2};
  const Polygon wall = parallelogram({0, -4, 0}, {0, 4, 0}, {0, 0, 4});
  const Polygon column = parallelogram({0.8, -0.15, 0.02}, {0, 0.3, 0}, {0, 0, 5});
  const Scene scene{{kFloor, wall, column}}, columns{{column}};
  const Rendering rendering = render(scene, Shot::perspective(eye, {0.3, 0, 0.6}, 50, 240, 180));
  const auto pixels =
      receivers(rendering, 1, kEvery, [](const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.5; });
  ASSERT_GE(pixels.size(), 30u);
  for (const Estimator estimator : kSampled) {
    const std::vector<float> ao = ao_of(rendering.frame, thin(estimator, 1, Completion::all));
    constexpr double kSampling = 0.008;  // what the distance of the samples costs
    double largest = 0;
    for (const std::size_t i : pixels) {
      const Hit& receiver = rendering.hits[i];
      double missed = 0;
      const double added = mean_over_rays(scene, receiver, kRaysAcross, [&](const Hit& hit, const Vec3& direction) {
        const double to_plane = -receiver.position.x / direction.x;
        if (!(to_plane > 0 && to_plane < 1)) return 0.0;
        const Vec3 on_plane = receiver.position + to_plane * direction;
        if (columns.hit({eye, on_plane - eye}).distance >= 1) return 0.0;
        missed += hit.primitive == 1 ? 1.0 / (kRaysAcross * kRaysAcross) : 0;
        return hit.distance >= 1 ? 1.0 : 0.0;
      });
      const double truth = true_ao(scene, receiver, 1, kRaysAcross);
      EXPECT_GE(ao[i], truth - added - kSampling) << i << ", not wall " << added << ", estimator " << int(estimator);
      EXPECT_LE(ao[i], truth + missed + kSampling) << i << ", wall " << missed << ", estimator " << int(estimator);
      largest = std::max(largest, added);
    }
    EXPECT_GE(largest, 5 * kSampling);
  }
}

/// The same frame as if its data window began so many rows lower.
HostFrame without_upper_rows(const HostFrame& frame, int rows) {
  HostFrame lower = frame;
  lower.data.y += rows;
  lower.data.height -= rows;
  lower.depth = cropped(frame.depth, frame.data, lower.data);
  lower.normal = cropped(frame.normal, frame.data, lower.data);
  return lower;
}

// A picture of a wall whose upper part is cut off, against the whole.
TEST(Pieces, of_a_wall_go_on_beyond_the_border_as_in_a_wider_picture) {
  const Scene scene{{kFloor, kWall}};
  for (const Shot& shot : {oblique(Shot::perspective({5, 0.4, 1.8}, {0.3, 0, 0.6}, 50, 240, 180)),
                           Shot::orthographic({5, 0.4, 1.8}, {0.3, 0, 0.6}, 5, 240, 180)}) {
    const Rendering whole = render(scene, shot);
    int cut = 0;  // the first row whose wall is no more than 0.25 high
    while (whole.at(120, cut).position.z > 0.25) cut++;
    const HostFrame frame = without_upper_rows(whole.frame, cut);
    std::vector<std::size_t> pixels =
        receivers(whole, 1, kEvery, [](const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.7; });
    ASSERT_GE(pixels.size(), 30u);
    for (const Estimator estimator : kSampled) {
      const std::vector<float> expected = ao_of(whole.frame, thin(estimator, 1, Completion::none));
      std::vector<double> truth;
      std::vector<std::size_t> below;
      for (const std::size_t i : pixels) truth.push_back(expected[i]);
      for (const std::size_t i : pixels) below.push_back(i - std::size_t(cut * frame.data.width));
      const double none = mean_error(ao_of(frame, thin(estimator, 1, Completion::none)), below, truth);
      for (const Completion complete : {Completion::border, Completion::all}) {
        const double error = mean_error(ao_of(frame, thin(estimator, 1, complete)), below, truth);
        EXPECT_LE(error, 0.0095) << "estimator " << int(estimator) << ", completion " << int(complete);
        EXPECT_GE(none, 10 * error) << "estimator " << int(estimator) << ", completion " << int(complete);
      }
    }
  }
}

/// Turns each normal by up to so many degrees.
void roughen(HostFrame& frame, double degrees) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> tilt(-1, 1);
  const double slope = std::tan(degrees * std::numbers::pi / 180) / std::numbers::sqrt2;
  const std::size_t pixels = frame.data.pixels();
  for (std::size_t i = 0; i < pixels; i++) {
    Vec3 n{frame.normal[i], frame.normal[i + pixels], frame.normal[i + 2 * pixels]};
    const Vec3 across = unit(cross(n, {1, 0, 0}));
    n = unit(n + slope * tilt(random) * across + slope * tilt(random) * cross(n, across));
    frame.normal[i] = float(n.x);
    frame.normal[i + pixels] = float(n.y);
    frame.normal[i + 2 * pixels] = float(n.z);
  }
}

TEST(Pieces, of_a_floor_that_the_border_cuts_stay_below_the_receiver) {
  for (const Shot& shot :
       {Shot::perspective({0, -3, 2}, {0, 0, 0}, 40, 120, 90), Shot::orthographic({0, -3, 2}, {0, 0, 0}, 3, 120, 90)}) {
    for (const double degrees : {0.0, 3.0}) {
      HostFrame floor = render({{kFloor}}, shot).frame;
      if (degrees > 0) roughen(floor, degrees);
      for (const Estimator estimator : kSampled) {
        const std::vector<float> none = ao_of(floor, thin(estimator, 1, Completion::none));
        const std::vector<float> all = ao_of(floor, thin(estimator, 1, Completion::all));
        const Difference d = difference(all, none);
        EXPECT_EQ(d.max, 0) << "estimator " << int(estimator) << ", " << place(d, floor);
      }
    }
  }
}

TEST(Pieces, are_not_of_a_thing_alone_before_the_sky) {
  const Scene things[] = {{{Sphere{.center = {0, 0, 0}, .radius = 1}}},
                          {{parallelogram({-1, -1, -0.5}, {2, 0.3, 0}, {0, 2, 1})}},
                          {{parallelogram({-1, 0, -1}, {0.05, 0, 0}, {0, 0, 2})}}};
  for (const Scene& scene : things) {
    for (const Shot& shot : {Shot::perspective({3, -4, 2}, {0, 0, 0}, 60, 120, 96),
                             Shot::orthographic({3, -4, 2}, {0, 0, 0}, 6, 120, 96)}) {
      const HostFrame frame = render(scene, shot).frame;
      for (const Estimator estimator : kSampled) {
        const Planes all = planes_of(frame, thin(estimator, 0.8, Completion::all));
        EXPECT_TRUE(same_bits(all.ao, ao_of(frame, thin(estimator, 0.8, Completion::none)))) << int(estimator);
        EXPECT_EQ(all.completed, std::vector<float>(all.ao.size(), 0.0f)) << int(estimator);
      }
    }
  }
}

/// The picture in which a plate hides a part of a wall.
const HostFrame& plate_frame() {
  static const HostFrame frame =
      render(kPlateScene, Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, 160, 120)).frame;
  return frame;
}

TEST(Pieces, of_several_radii_are_those_of_each) {
  for (const Estimator estimator : kSampled) {
    EstimatorSettings settings = thin(estimator, 1, Completion::all);
    const std::vector<float> alone = ao_of(plate_frame(), settings);
    settings.further_radii = {0.3};
    const Planes both = planes_of(plate_frame(), settings);
    ASSERT_EQ(both.scales.size(), 2 * alone.size());
    EXPECT_TRUE(same_bits(alone, {both.scales.begin() + std::ptrdiff_t(alone.size()), both.scales.end()}));
  }
}

// A piece weighs by the distance of its middle, and the reference by that of each of its parts.
TEST(Pieces, weigh_by_the_falloff) {
  const auto share = [](const std::vector<float>& faded, const std::vector<float>& hard) {
    return std::accumulate(faded.begin(), faded.end(), 0.0) / std::accumulate(hard.begin(), hard.end(), 0.0);
  };
  for (const Estimator estimator : kSampled) {
    EstimatorSettings settings = thin(estimator, 1, Completion::all);
    ReferenceSettings some = reference_settings_of(settings);
    for (std::size_t i = 0; i < plate_frame().data.pixels(); i += 61) some.pixels.push_back(i);
    const std::vector<float> exact = reference_completed(plate_frame(), some);
    const std::vector<float> hard = planes_of(plate_frame(), settings).completed;
    settings.falloff = Falloff::smooth;
    some.falloff = Falloff::smooth;
    const double expected = share(reference_completed(plate_frame(), some), exact);
    const double weight = share(planes_of(plate_frame(), settings).completed, hard);
    EXPECT_NEAR(weight, expected, 0.33 * expected) << int(estimator);
  }
}

// Interruptions are found among 32 samples at a time. A run that crosses from one lot to the next hides no more than to
// the end of its lot, so that of 70 samples up to 3 tenths of what goes on is missed. A radius is 70 pixels wide here.
TEST(Pieces, are_found_among_any_number_of_samples) {
  const HostFrame frame = render(kPlateScene, Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.4}, 25, 160, 120)).frame;
  ReferenceSettings some = reference_settings_of(thin(Estimator::gtao, 1, Completion::all));
  for (std::size_t i = 0; i < frame.data.pixels(); i += 49) some.pixels.push_back(i);
  const std::vector<float> expected = reference_completed(frame, some);
  double whole = 0;
  for (const std::size_t i : some.pixels) whole += expected[i];
  for (const Estimator estimator : kSampled) {
    for (const int steps : {32, 40, 70}) {
      EstimatorSettings settings = thin(estimator, 1, Completion::all);
      settings.steps = steps;
      const std::vector<float> completed = planes_of(frame, settings).completed;
      double sum = 0;
      for (const std::size_t i : some.pixels) sum += completed[i];
      EXPECT_GE(sum / whole, 0.69) << "estimator " << int(estimator) << ", steps " << steps;
      EXPECT_LE(sum / whole, 1.05) << "estimator " << int(estimator) << ", steps " << steps;
    }
  }
}

TEST(Pieces, tell_what_would_be_open_without_them) {
  for (const Estimator estimator : kSampled) {
    const Planes all = planes_of(plate_frame(), thin(estimator, 1, Completion::all));
    const std::vector<float> none = ao_of(plate_frame(), thin(estimator, 1, Completion::none));
    const Difference d = difference(all.completed, [&](std::size_t i) { return none[i] - all.ao[i]; });
    const double sum = std::accumulate(all.completed.begin(), all.completed.end(), 0.0);
    EXPECT_LE(std::abs(d.bias), 0.01 * sum / double(all.ao.size())) << int(estimator);
    EXPECT_LE(d.rmse, 1e-3) << int(estimator);
    EXPECT_GT(std::ranges::max(all.completed), 0.2);
  }
}

TEST(Pieces, lower_the_confidence) {
  for (const Estimator estimator : kSampled) {
    const Planes all = planes_of(plate_frame(), thin(estimator, 1, Completion::all));
    double by_pieces = 0, others = 0;
    int pieces = 0, without = 0;
    for (std::size_t i = 0; i < all.ao.size(); i++) {
      if (all.completed[i] > 0.1) by_pieces += all.confidence[i], pieces++;
      if (all.completed[i] == 0) others += all.confidence[i], without++;
    }
    ASSERT_GT(pieces, 100);
    ASSERT_GT(without, 100);
    EXPECT_LT(by_pieces / pieces, 0.5 * others / without) << int(estimator);
  }
}

TEST(Pieces, are_none_of_other_estimators) {
  const Planes all = planes_of(plate_frame(), thin(Estimator::hbao, 1, Completion::all));
  const Planes none = planes_of(plate_frame(), thin(Estimator::hbao, 1, Completion::none));
  EXPECT_TRUE(all.completed.empty());
  EXPECT_TRUE(same_bits(all.ao, none.ao));
  EXPECT_TRUE(same_bits(all.confidence, none.confidence));
}

/// What the next frame of a lane gives, and how many tiles were kept of the one before.
std::pair<std::vector<float>, std::uint32_t> next_of(Lane& lane, const HostFrame& frame,
                                                     const EstimatorSettings& settings) {
  FrameInputs inputs = upload(lane.gpu, frame);
  EXPECT_FALSE(lane.last.is_same(lane.gpu, inputs, settings));
  const FrameOutputs outputs = run_chain(lane.gpu, inputs, settings, {});
  lane.gpu.run();
  lane.last.keep(outputs);
  return {values_of(outputs.ao), outputs.tiles->as<TileCounts>()[0].kept};
}

// A surface goes on in the plane of its normal. What turns only that changes what others see of it.
TEST(Pieces, follow_normals_that_change_from_frame_to_frame) {
  const Scene scene{{kFloor, kWall, parallelogram({0.3, -0.5, 0.17}, {0, 1, 0}, {0, 0, 0.3})}};
  const Rendering rendering = render(scene, Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, 240, 180));
  HostFrame turned = rendering.frame;
  for (std::size_t i = 0; i < turned.data.pixels(); i++)
    if (rendering.hits[i].primitive == 1 && std::abs(rendering.hits[i].position.y) < 0.2) turned.normal[i] += 0.3f;
  const auto others_changed = [&](const std::vector<float>& before, const std::vector<float>& after) {
    int others = 0;
    for (std::size_t i = 0; i < after.size(); i++) others += rendering.hits[i].primitive == 0 && after[i] != before[i];
    return others;
  };
  for (const Estimator estimator : kSampled) {
    EstimatorSettings settings = thin(estimator, 0.4, Completion::all);
    Lane lane(device());
    const std::vector<float> before = next_of(lane, rendering.frame, settings).first;
    const auto [after, kept] = next_of(lane, turned, settings);
    EXPECT_TRUE(same_bits(after, ao_of(turned, settings))) << int(estimator);
    EXPECT_GT(kept, 0u) << int(estimator);
    EXPECT_GT(others_changed(before, after), 50) << int(estimator);
    settings.complete = Completion::none;
    EXPECT_EQ(others_changed(ao_of(rendering.frame, settings), ao_of(turned, settings)), 0) << int(estimator);
  }
}

using PiecesOfFiles = CommandLine;

TEST_F(PiecesOfFiles, of_a_region_are_those_of_the_whole_where_normals_come_from_depth) {
  const Window data{-8, -4, 500, 200}, display{0, 0, 490, 190}, region{159, 14, 127, 60};
  FrameFile barred = wall_frame(data, display);
  for (const char* axis : {"X", "Y", "Z"}) barred.planes.erase(std::string("ViewLayer.Normal.") + axis);
  std::vector<float>& depth = barred.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) {
    const auto x = i % std::size_t(data.width), y = i / std::size_t(data.width);
    depth[i] *= float(1 + 0.01 * std::sin(0.1 * double(x)) * std::sin(0.07 * double(y)) - (x / 20 % 3 == 0 ? 0.1 : 0));
  }
  barred.write(frame);
  write_bytes(camera, wall_camera(display).dump());
  for (const char* estimator : {"gtao", "bitmask"}) {
    std::vector<std::string> arguments{"run",    frame,          "-o",       ao,    "--camera",    camera,
                                       "--type", "float",        "--radius", "0.6", "--estimator", estimator,
                                       "--set",  "complete=none"};
    ASSERT_EQ(run_program(arguments).code, 0);
    const Image none = read_exr_image(ao);
    arguments.back() = "complete=all";
    ASSERT_EQ(run_program(arguments).code, 0);
    const Image whole = read_exr_image(ao);
    EXPECT_FALSE(same_bits(cropped(none.pixels, none.data, region), cropped(whole.pixels, whole.data, region)));
    arguments.insert(arguments.end(), {"--roi", "159,14,127,60"});
    ASSERT_EQ(run_program(arguments).code, 0);
    EXPECT_TRUE(same_bits(read_exr_image(ao).pixels, cropped(whole.pixels, whole.data, region))) << estimator;
  }
}

}  // namespace
}  // namespace alcove
