// Half and quarter resolution: planes stay open, nothing shifts, surfaces keep to themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using test::difference, test::Difference, test::mirrored, test::same_bits;
using test::Plane, test::Rendering, test::Scene, test::Shot, test::unit, test::Vec3;

constexpr double kRadian = std::numbers::pi / 180;
const Vec3 kForward{1, 0, 0};

EstimatorSettings settings_of(double radius, int slices, int steps, Resolution resolution,
                              Denoise denoise = Denoise::none) {
  EstimatorSettings settings = test::plain_settings();
  settings.radius = radius;
  settings.slices = slices;
  settings.steps = steps;
  settings.resolution = resolution;
  settings.denoise = denoise;
  return settings;
}

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(test::recorder(), frame, settings).ao;
}

void expect_open(const HostFrame& frame, const EstimatorSettings& settings, const std::string& what) {
  const Difference d = difference(run(frame, settings), [](std::size_t) { return 1.0; });
  EXPECT_LE(d.max, 1e-4) << what << ", resolution 1/" << int(settings.resolution) << ", radius " << *settings.radius
                         << ", " << test::place(d, frame);
}

class Reduced : public testing::TestWithParam<Resolution> {
 protected:
  Resolution resolution() const { return GetParam(); }
  int factor() const { return int(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(, Reduced, testing::Values(Resolution::half, Resolution::quarter),
                         [](const auto& value) { return value.param == Resolution::half ? "half" : "quarter"; });

TEST_P(Reduced, plane_is_open_at_every_tilt_and_field_of_view) {
  for (const double tilt : {0.0, 30.0, 60.0, 80.0, 85.0}) {
    for (const double turn : {0.0, 37.0, 90.0, 200.0}) {
      const double sine = std::sin(tilt * kRadian);
      const Vec3 normal{-std::cos(tilt * kRadian), sine * std::cos(turn * kRadian), sine * std::sin(turn * kRadian)};
      const Scene scene{{Plane{.point = {5, 0, 0}, .normal = normal}}};
      for (const double fov : {0.0, 10.0, 60.0, 90.0, 120.0}) {
        const Shot shot =
            fov > 0 ? Shot::perspective({}, kForward, fov, 64, 48) : Shot::orthographic({}, kForward, 0.5, 64, 48);
        const Rendering rendering = test::render(scene, shot);
        const std::string what =
            "tilt " + std::to_string(tilt) + " turn " + std::to_string(turn) + " fov " + std::to_string(fov);
        for (const double radius : {0.5, 3.0, 1e5})
          for (const Denoise denoise : {Denoise::none, Denoise::bilateral})
            expect_open(rendering.frame, settings_of(radius, 3, 6, resolution(), denoise), what);
      }
    }
  }
}

TEST_P(Reduced, sizes_may_be_anything_from_one_pixel) {
  const Scene plane{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})}}};
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 5}, {5, 3}, {8, 8}, {9, 7}, {17, 31}, {161, 91}, {1, 300}}) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    for (const Denoise denoise : {Denoise::none, Denoise::bilateral, Denoise::box}) {
      expect_open(test::render(plane, Shot::perspective({}, kForward, 40, width, height)).frame,
                  settings_of(1, 3, 6, resolution(), denoise), size);
      for (const HostFrame& frame : {test::furnished_room(width, height).frame, test::random_bits(width, height, 5)})
        for (const float ao : run(frame, settings_of(0.6, 3, 6, resolution(), denoise)))
          ASSERT_TRUE(ao >= 0 && ao <= 1) << size << ": " << ao;
    }
  }
}

// A visibility that changes evenly over the image comes back as it was: half a pixel's shift would be 0.5 x 0.004 off.
TEST_P(Reduced, ramp_comes_back_where_it_was) {
  const double by_x = 0.004, by_y = -0.003;
  for (const Vec3 normal : {Vec3{-1, 0, 0}, unit({-1, 0.7, 0.9})}) {
    const Rendering rendering =
        test::render({{Plane{.point = {5, 0, 0}, .normal = normal}}}, Shot::perspective({}, kForward, 50, 97, 71));
    const auto ramp = [&](double x, double y) { return 0.4 + by_x * x + by_y * y; };
    const auto at_center = [&](int x, int y) { return ramp((x + 0.5) * factor(), (y + 0.5) * factor()); };
    const auto ao = test::upsampled(rendering.frame, at_center, settings_of(1, 1, 1, resolution()));
    int compared = 0;
    for (int y = factor(); y < 71 - 2 * factor(); y++) {
      for (int x = factor(); x < 97 - 2 * factor(); x++, compared++)
        ASSERT_NEAR(ao[std::size_t(y * 97 + x)], ramp(x + 0.5, y + 0.5), 2e-4) << x << " " << y;
    }
    EXPECT_GT(compared, 3000);
  }
}

/// How far one result would have to be moved to fit another best, by least squares, over what is away from the edges of
/// surfaces.
std::pair<double, double> shift_of(const std::vector<float>& moved, const std::vector<float>& still,
                                   const Rendering& rendering,
                                   const std::function<std::pair<int, int>(int, int)>& source) {
  const int width = rendering.shot.data.width, height = rendering.shot.data.height;
  double xx = 0, xy = 0, yy = 0, x_error = 0, y_error = 0;
  for (int y = 8; y < height - 8; y++) {
    for (int x = 8; x < width - 8; x++) {
      const auto [source_x, source_y] = source(x, y);
      if (rendering.primitives_within(6, source_x, source_y) > 1) continue;
      const auto at = [&](int u, int v) { return double(still[std::size_t(v * width + u)]); };
      const double dx = (at(x + 2, y) - at(x - 2, y)) / 4, dy = (at(x, y + 2) - at(x, y - 2)) / 4;
      const double error = at(x, y) - moved[std::size_t(y * width + x)];
      xx += dx * dx, xy += dx * dy, yy += dy * dy, x_error += dx * error, y_error += dy * error;
    }
  }
  const double determinant = xx * yy - xy * xy;
  return {(yy * x_error - xy * y_error) / determinant, (xx * y_error - xy * x_error) / determinant};
}

// The same through the whole chain, beside a wall. That few pixels see less of the wall looks like a shift away from
// it; in the mirrored frame that is a shift to the other side, which a real one is not.
// What goes on beyond the border begins at once as its slice turns, so with 16 slices it is noise that looks like a
// shift of 0.36 px at a quarter. It falls as slices are added, which a shift does not: to 0.069 px of 48, and to 0.035
// px of 128. So what completes surfaces has 48.
TEST_P(Reduced, shading_of_a_wall_does_not_shift) {
  const Scene scene{{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}}}};
  for (const auto& [completion, slices] : {std::pair{Completion::none, 16}, {Completion::all, 48}})
    for (const Vec3 eye : {Vec3{4, -1, 3}, Vec3{3, 3, 3}}) {
      const Rendering rendering = test::render(scene, Shot::perspective(eye, {0.7, 0, 0.3}, 45, 160, 120));
      EstimatorSettings reduced = settings_of(1, slices, 64, resolution());
      reduced.complete = completion;
      EstimatorSettings whole = reduced;
      whole.resolution = Resolution::full;
      for (const bool left_right : {true, false}) {
        double sum_x = 0, sum_y = 0;
        for (const bool flip : {false, true}) {
          const HostFrame frame = flip ? mirrored(rendering.frame, left_right) : rendering.frame;
          const auto source = [&](int x, int y) {
            return !flip ? std::pair{x, y} : left_right ? std::pair{159 - x, y} : std::pair{x, 119 - y};
          };
          const auto [x, y] = shift_of(run(frame, reduced), run(frame, whole), rendering, source);
          sum_x += x;
          sum_y += y;
        }
        EXPECT_LE(std::abs(left_right ? sum_x : sum_y) / 2, 0.1)
            << "px in " << (left_right ? "x" : "y") << ", completion " << int(completion);
      }
    }
}

// Beyond a step, pixels take the blocks of their own depth as soon as one of the four about them has it.
TEST_P(Reduced, surfaces_beside_a_step_keep_to_themselves) {
  for (int edge = 36; edge < 40; edge++) {
    Rendering rendering =
        test::render({{Plane{.point = {5, 0, 0}, .normal = kForward}}}, Shot::perspective({}, kForward, 60, 80, 60));
    for (int i = 0; i < 80 * 60; i++)
      if (i % 80 >= edge) rendering.frame.depth[std::size_t(i)] = 8;
    const int near_blocks = (edge + factor() - 1) / factor();
    const auto ao = test::upsampled(
        rendering.frame, [&](int x, int) { return x < near_blocks ? 0 : 1; }, settings_of(1, 1, 1, resolution()));
    for (int i = 0; i < 80 * 60; i++) {
      // the last near block's centre: from here on one of the four is far
      const double first_far_tap = (near_blocks - 0.5) * factor();
      if (i % 80 < edge) ASSERT_EQ(ao[std::size_t(i)], 0.0f) << "edge " << edge << " x " << i % 80;
      if (i % 80 >= edge && i % 80 > first_far_tap)
        ASSERT_EQ(ao[std::size_t(i)], 1.0f) << "edge " << edge << " x " << i % 80;
    }
  }
}

TEST_P(Reduced, sky_is_open_and_lightens_nothing) {
  const Rendering room = test::furnished_room(97, 71);
  const auto ao = test::upsampled(
      room.frame, [](int, int) { return 0.0; }, settings_of(1, 1, 1, resolution()));
  for (std::size_t i = 0; i < ao.size(); i++) ASSERT_EQ(ao[i], room.hits[i].primitive < 0 ? 1.0f : 0.0f) << i;
  HostFrame empty = room.frame;
  std::ranges::fill(empty.depth, test::kSky);
  for (const float value : run(empty, settings_of(1, 3, 6, resolution(), Denoise::bilateral))) ASSERT_EQ(value, 1.0f);
}

// Blocks are the display window's: a crop at any place has those of the whole frame.
TEST_P(Reduced, crop_is_the_whole_frame_there) {
  const Rendering whole = test::furnished_room(192, 144);
  const EstimatorSettings settings = settings_of(0.25, 3, 6, resolution(), Denoise::bilateral);
  const std::vector<float> expected = run(whole.frame, settings);
  HostFrame crop = whole.frame;
  crop.data = {37, 21, 110, 93};
  const std::size_t pixels = crop.data.pixels();
  crop.depth.resize(pixels);
  crop.normal.resize(3 * pixels);
  const auto place = [&](std::size_t i) { return (i / 110 + 21) * 192 + i % 110 + 37; };
  for (std::size_t i = 0; i < pixels; i++) {
    crop.depth[i] = whole.frame.depth[place(i)];
    for (std::size_t axis = 0; axis < 3; axis++)
      crop.normal[i + axis * pixels] = whole.frame.normal[place(i) + axis * 192 * 144];
  }
  const std::vector<float> ao = run(crop, settings);
  int darkened = 0;
  for (std::size_t i = 0; i < pixels; i++) {
    const std::size_t x = i % 110, y = i / 110;
    if (x < 36 || y < 36 || x >= 110 - 36 || y >= 93 - 36) continue;
    EXPECT_EQ(ao[i], expected[place(i)]) << x << " " << y;
    darkened += ao[i] < 0.95;
  }
  EXPECT_GT(darkened, 30);
}

TEST_P(Reduced, mirrored_blocks_give_the_mirrored_result) {
  const HostFrame frame = test::furnished_room(96, 72).frame;
  const auto value = [](int x, int y) { return (x * 7 + y * 13) % 32 / 31.0; };
  const int columns = 96 / factor(), rows = 72 / factor();
  const std::vector<float> upright = test::upsampled(frame, value, settings_of(1, 1, 1, resolution()));
  for (const bool left_right : {true, false}) {
    const auto mirrored_value = [&](int x, int y) {
      return left_right ? value(columns - 1 - x, y) : value(x, rows - 1 - y);
    };
    const Difference d =
        difference(test::upsampled(mirrored(frame, left_right), mirrored_value, settings_of(1, 1, 1, resolution())),
                   mirrored(upright, frame, left_right));
    EXPECT_LE(d.max, 2e-3) << test::place(d, frame);
    EXPECT_LE(d.mean, 1e-5);
  }
}

TEST_P(Reduced, is_the_same_to_the_bit_in_units_of_any_power_of_two) {
  const HostFrame frame = test::furnished_room(97, 71).frame;
  const std::vector<float> expected = run(frame, settings_of(0.6, 3, 6, resolution(), Denoise::bilateral));
  for (const int exponent : {-20, 3, 24}) {
    const EstimatorSettings settings = settings_of(std::ldexp(0.6, exponent), 3, 6, resolution(), Denoise::bilateral);
    EXPECT_TRUE(same_bits(run(test::scaled(frame, exponent), settings), expected)) << exponent;
  }
}

}  // namespace
}  // namespace alcove
