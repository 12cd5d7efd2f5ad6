// Lines of pixels: what each count finds on lines that are drawn for it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/walk.h"

#include <cmath>
#include <functional>
#include <random>

#include "tests/support/program.h"

namespace alcove::lines_test {
namespace {

/// A line of so many pixels by their depth; 0 and infinity are no surface.
Line line_of(const std::function<double(int)>& depth, int size = 200) {
  Line line;
  for (int i = 0; i < size; i++) {
    const double z = depth(i);
    line.raw.push_back(float(z));
    line.inverse.push_back(z > 0 && std::isfinite(z) ? 1 / double(float(z)) : 0);
  }
  return line;
}

double slanted(double i) { return 1 / (0.3 + 0.0005 * i); }
/// Two surfaces, the first one in front.
double step(double i) { return i < 100 ? 2 : slanted(i); }

Repeats repeats(const std::function<double(int)>& depth) {
  BorderCounts counts;
  for (int i = 0; i < 20; i++) count_repeats(line_of(depth), counts);
  return repeats_of(counts, 20);
}

TEST(Lines, repeated_pixels_of_a_slant_stand_at_the_same_borders) {
  const Repeats whole = repeats(slanted), twice = repeats([](int i) { return slanted(i / 2); }),
                more = repeats([](int i) { return slanted(std::floor(i / 1.5)); });
  EXPECT_EQ(whole.equal, 0);
  EXPECT_EQ(whole.steps, whole.borders);
  EXPECT_NEAR(twice.equal, twice.borders / 2, 1);
  EXPECT_NEAR(more.equal, more.borders / 3, 1);
  EXPECT_EQ(more.equal + more.steps, more.borders);
}

TEST(Lines, a_wall_from_the_front_has_no_places_that_tell_of_repeats) {
  EXPECT_EQ(repeats([](int) { return 4; }).borders, 0);
}

Outlines outlines(const std::function<double(int)>& depth) {
  Outlines found;
  count_outlines(line_of(depth), found);
  return found;
}

TEST(Lines, an_outline_is_sharp_if_it_lies_between_two_pixels) {
  EXPECT_EQ(outlines(step).count, 1);
  EXPECT_EQ(outlines(step).sharp, 1);
  const auto blurred = [](int i) { return (step(i - 1) + step(i) + step(i + 1)) / 3; };
  EXPECT_EQ(outlines(blurred).count, 1);
  EXPECT_EQ(outlines(blurred).sharp, 0);
  EXPECT_EQ(outlines([](int i) { return 1 / (0.001 + 0.002 * i); }).count, 0) << "a floor up to its horizon";
}

TEST(Lines, one_pixel_between_two_surfaces_is_blended) {
  const auto blended = [](int i) { return i == 100 ? 0.5 * (step(99) + step(101)) : step(i); };
  EXPECT_EQ(outlines(blended).blended, 1);
  EXPECT_EQ(outlines(blended).steps, 1);
  EXPECT_EQ(outlines(step).blended, 0);
  EXPECT_EQ(outlines(step).steps, 1);
}

TEST(Lines, holes_lie_between_surfaces_of_one_depth) {
  Holes holes;
  count_holes(line_of([](int i) { return i % 20 == 7 ? 0 : slanted(i); }), holes);
  EXPECT_EQ(holes.between, 10);
  EXPECT_EQ(holes.within_planes, 10);
  Holes gap;
  count_holes(line_of([](int i) { return i == 100 || i == 101 ? 0 : step(i); }), gap);
  EXPECT_EQ(gap.between, 0) << "between two surfaces";
  Holes sky;
  count_holes(line_of([](int i) { return i < 50 ? 0 : slanted(i); }), sky);
  EXPECT_EQ(sky.between, 0);
  EXPECT_EQ(sky.surfaces, 150);
}

TEST(Lines, noise_alternates_and_surfaces_do_not) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  BendSample noisy, round;
  for (int i = 0; i < 20; i++) {
    sample_bends(line_of([&](int k) { return slanted(k) * (1 + noise(random)); }), noisy);
    sample_bends(line_of([](int k) { return 5 - std::sqrt(40000.0 - (k - 100.0) * (k - 100.0)) / 50; }), round);
  }
  EXPECT_GT(double(noisy.opposite), 0.65 * double(noisy.neighbours));
  EXPECT_LT(double(round.opposite), 0.1 * double(round.neighbours));
}

TEST(Lines, a_range_that_begins_again_drops_by_itself) {
  DropSample wrapped, edge;
  for (int i = 0; i < 20; i++) {
    sample_drops(line_of([](int k) { return std::fmod(3 + 0.02 * k, 4.096); }), wrapped);
    sample_drops(line_of([&](int k) { return k < 100 ? 0.001 * i + 0.0001 * k : 4; }), edge);
  }
  const Wrapping found = wrapping_of(wrapped);
  EXPECT_EQ(found.whole, found.drops);
  EXPECT_NEAR(found.period, 4.096, 0.005);
  EXPECT_EQ(wrapping_of(edge).whole, 0);
}

std::vector<int> shifts(int displaced) {
  Line line = line_of(step);
  std::vector<float> normals;
  for (const double component : {1.0, 0.0})
    for (int i = 0; i < 200; i++) normals.push_back(float(i < 100 + displaced ? component : 1 - component));
  normals.resize(600);
  line.normals = normals;
  line.pixels = 200;
  std::vector<int> found;
  sample_normal_shifts(line, found);
  return found;
}

TEST(Lines, normals_change_where_depth_does_or_beside_it) {
  EXPECT_EQ(shifts(0), std::vector<int>{0});
  EXPECT_EQ(shifts(3), std::vector<int>{3});
  EXPECT_EQ(shifts(-2), std::vector<int>{-2});
}

constexpr Window kPicture{0, 0, 128, 96};

std::optional<EmptyRectangle> rectangle_in(const std::function<double(int, int)>& depth, const Window& frame = kPicture,
                                           bool is_sky_0 = false) {
  std::vector<float> plane;
  std::vector<PlacedRuns> rows;
  for (int y = 0; y < kPicture.height; y++) {
    const Line line = line_of([&](int x) { return depth(x, y); }, kPicture.width);
    plane.insert(plane.end(), line.raw.begin(), line.raw.end());
    if (y % 2) rows.push_back({y, empty_runs(line)});
  }
  return empty_rectangle(plane, kPicture, frame, rows, is_sky_0);
}

TEST(Lines, a_rectangle_of_0_is_no_sky_if_the_sky_has_another_value) {
  const auto sky = [](int y) { return y < 20 ? std::numeric_limits<double>::infinity() : 3; };
  const auto tile = rectangle_in([&](int x, int y) { return x >= 41 && x < 83 && y >= 33 && y < 62 ? 0 : sky(y); });
  ASSERT_TRUE(tile);
  EXPECT_TRUE(tile->is_unlike_sky);
  EXPECT_EQ((std::array{tile->left, tile->top, tile->right, tile->bottom}), (std::array{41, 33, 83, 62}));
  EXPECT_FALSE(rectangle_in([&](int, int y) { return sky(y); }));
  const auto window = [&](int x, int y) { return x >= 41 && x < 83 && y >= 33 && y < 62 ? 0 : sky(y); };
  EXPECT_FALSE(rectangle_in(window, kPicture, true)) << "disparity of a window is 0";
}

TEST(Lines, a_window_is_no_tile_unless_its_sides_stand_on_the_grid) {
  const auto room = [](int left, int top, int right, int bottom) {
    return rectangle_in([=](int x, int y) { return x >= left && x < right && y >= top && y < bottom ? 0 : 3; });
  };
  EXPECT_FALSE(room(41, 33, 83, 62));
  EXPECT_FALSE(room(32, 33, 64, 62));
  ASSERT_TRUE(room(32, 16, 64, 48));
  EXPECT_TRUE(room(32, 16, 64, 48)->is_on_grid);
}

TEST(Lines, a_rectangle_of_a_part_has_its_place_in_the_frame_and_ends_within_the_part) {
  const Window frame{0, -40, 128, 200};
  const auto tile = [&](int top, int bottom) {
    return rectangle_in(
        [=](int x, int y) { return x >= 32 && x < 64 && y >= top && y < bottom ? 0
                                   : y < 4 && x > 100                          ? INFINITY
                                                                               : 3; },
        frame);
  };
  ASSERT_TRUE(tile(30, 60));
  EXPECT_EQ((std::array{tile(30, 60)->top, tile(30, 60)->bottom}), (std::array{70, 100}));
  EXPECT_FALSE(tile(30, 96)) << "it may go on below";
}

TEST(Lines, one_of_many_windows_stands_on_the_grid_by_chance) {
  const auto windows = [](int height, int each) {
    return rectangle_in([=](int x, int y) {
      const bool is_window = each && x < 94 && x % each >= 4 && x % each < 13 && y < 60 && y % 13 >= 5;
      const bool is_on_grid = x >= 112 && y >= 16 && y < height;
      return is_on_grid || is_window ? 0 : 3;
    });
  };
  EXPECT_TRUE(windows(32, 0));
  EXPECT_FALSE(windows(32, 16)) << "beside so many others";
}

/// What a walk over a wall of depth 9 beside a slant shows, by normals of the wall's places.
Findings walked(const std::function<Vector3(int, int)>& normal) {
  Reading reading;
  reading.data = reading.display = kPicture;
  reading.camera.width = kPicture.width, reading.camera.height = kPicture.height;
  reading.camera.fx = reading.camera.fy = 100;
  reading.camera.cx = 64, reading.camera.cy = 48;
  std::vector<float> depth, normals(3 * kPicture.pixels());
  for (int y = 0; y < kPicture.height; y++)
    for (int x = 0; x < kPicture.width; x++) {
      const Vector3 n = normal(x, y);
      for (std::size_t c = 0; c < 3; c++) normals[c * kPicture.pixels() + depth.size()] = float(n[c]);
      depth.push_back(x < 64 ? float(slanted(x)) : 9);
    }
  Findings found;
  walk({reading, kPicture, depth, normals, true}, found);
  return found;
}

TEST(Walk, the_tilt_of_a_plateau_is_that_of_its_mean_normal) {
  const auto tilt = [](const std::function<Vector3(int, int)>& normal) {
    const auto plateau = walked(normal).plateau;
    return plateau ? plateau->tilt : -1;
  };
  EXPECT_NEAR(tilt([](int, int) { return Vector3{0, 0, 1}; }), 0, 1e-6);
  EXPECT_NEAR(tilt([](int, int) { return Vector3{0.6, 0, 0.8}; }), 36.87, 0.01);
  EXPECT_EQ(tilt([](int, int y) { return Vector3{y % 2 ? 1.0 : -1.0, 0, 0}; }), 90) << "of no direction";
}

}  // namespace
}  // namespace alcove::lines_test
