// The exact search where surfaces behind the first one are known: closed forms, what may change no bit, and crops.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/long_tests.h"
#include "tests/support/scenes.h"
#include "tests/support/solid_peels.h"

namespace alcove {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;
const Plane kFloor{.point = {}, .normal = {0, 0, 1}}, kWallX{.point = {}, .normal = {1, 0, 0}};

EstimatorSettings settings_of(double radius, Completion complete = Completion::none,
                              SliceSearch search = SliceSearch::exact) {
  EstimatorSettings settings = plain_settings();
  settings.radius = radius;
  settings.slices = 16;
  settings.search = search;
  settings.thickness = ThicknessKind::automatic;
  settings.complete = complete;
  return settings;
}

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

/// The frame as it was before it had peels.
HostFrame without_peels(HostFrame frame) {
  frame.behind.clear();
  frame.behind_depth.clear();
  return frame;
}

using Truth = std::function<std::optional<double>(const Hit&)>;

/// How far the AO of the pixels that have a truth and are not beside an edge is from that, on the mean.
double mean_error(const Rendering& rendering, const HostFrame& frame, const EstimatorSettings& settings,
                  const Truth& truth) {
  const std::vector<float> ao = run(frame, settings);
  double sum = 0;
  int pixels = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    const int x = int(i) % frame.data.width, y = int(i) / frame.data.width;
    const Hit& hit = rendering.hits[i];
    if (hit.primitive < 0 || rendering.primitives_within(2, x, y) > 1) continue;
    const auto expected = truth(hit);
    if (!expected) continue;
    sum += std::abs(ao[i] - *expected);
    pixels++;
  }
  EXPECT_GT(pixels, 300);
  return sum / pixels;
}

/// Area of the segment of the unit disk beyond the chord at x.
double segment(double x) { return x >= 1 ? 0 : std::acos(x) - x * std::sqrt(1 - x * x); }

/// Visibility by rays, even in the disk below the hemisphere.
double by_rays(const Scene& scene, const Hit& hit, double radius) {
  constexpr int kRings = 24, kTurns = 64;
  const Vec3 n = hit.normal;
  const Vec3 s = unit(cross(n, std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), t = cross(n, s);
  int open = 0;
  for (int i = 0; i < kRings; i++) {
    for (int k = 0; k < kTurns; k++) {
      const double r = std::sqrt((i + 0.5) / kRings), a = 2 * kPi * (k + 0.5 * (i & 1)) / kTurns;
      const Vec3 direction = r * std::cos(a) * s + r * std::sin(a) * t + std::sqrt(1 - r * r) * n;
      open += scene.hit({hit.position + 1e-6 * n, direction}).distance > radius ? 1 : 0;
    }
  }
  return double(open) / (kRings * kTurns);
}

/// A plate that stands farther than the radius before the corner of floor and wall that it hides.
const Polygon kPlate = parallelogram({2.3, -0.6, 2.1}, {0, 1.2, 0}, {-0.14, 0, 0.14});

std::vector<Shot> shots_of_corner() {
  return {Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 50, 160, 120),
          Shot::orthographic({4, 0, 4}, {0.5, 0, 0.5}, 5, 160, 120)};
}

TEST(ExactHidden, a_wall_blocks_where_a_plate_hides_it) {
  const Scene scene{{kFloor, kWallX, kPlate}};
  for (const Shot& shot : shots_of_corner()) {
    Rendering rendering = render(scene, shot);
    const HostFrame first = rendering.frame;
    add_solid_peels(rendering, scene, 1);
    double known = 0;
    const auto truth = [&](const Hit& hit) -> std::optional<double> {
      if (hit.primitive > 1 || std::abs(hit.position.y) > 0.8 || !shot.sees_ball(hit.position, 1)) return std::nullopt;
      return 1 - segment(hit.primitive == 0 ? hit.position.x : hit.position.z) / kPi;
    };
    for (const SliceSearch search : {SliceSearch::exact, SliceSearch::every_pixel}) {
      for (const Completion complete : {Completion::none, Completion::all}) {
        if (!tried(shot.camera.orthographic + (search == SliceSearch::exact) + (complete == Completion::none), 2))
          continue;
        const EstimatorSettings settings = settings_of(1, complete, search);
        known = std::max(known, mean_error(rendering, rendering.frame, settings, truth));
        EXPECT_LE(known, 0.004) << int(complete);
      }
    }
    if (!shot.camera.orthographic) EXPECT_GT(mean_error(rendering, first, settings_of(1), truth), 2 * known);
  }
}

/// A ball before a ball, over a floor.
const Scene kBalls{{Plane{.point = {0, 0, -0.8}, .normal = {0, 0, 1}}, Sphere{.center = {0, 0, 0}, .radius = 0.7},
                    Sphere{.center = {1.6, 0.2, 0.3}, .radius = 0.5}}};
const std::vector<int> kSolidBalls = {1, 2};

TEST(ExactHidden, a_ball_before_a_ball_is_what_rays_see) {
  const Shot shot = Shot::perspective({6, 0, 2.5}, {0.4, 0, -0.2}, 40, 200, 150);
  Rendering rendering = render(kBalls, shot);
  const HostFrame first = rendering.frame;
  add_solid_peels(rendering, kBalls, 3, kSolidBalls);
  const auto truth = [&](const Hit& hit) -> std::optional<double> {
    if (std::abs(hit.position.y) > 1 || hit.position.x < -1 || hit.position.x > 2.6) return std::nullopt;
    const bool is_sample = int(1000 * (hit.position.x + 7 * hit.position.y + 13 * hit.position.z)) % 3 == 0;
    return is_sample ? std::optional(by_rays(kBalls, hit, 1.2)) : std::nullopt;
  };
  const double known = mean_error(rendering, rendering.frame, settings_of(1.2, Completion::border), truth);
  const double guessed = mean_error(rendering, first, settings_of(1.2, Completion::all), truth);
  EXPECT_LE(known, 0.005) << guessed;
  EXPECT_GT(guessed, 2 * known);
}

TEST(ExactHidden, a_corridor_is_known_behind_the_post_in_it) {
  // Two walls, of which a post hides a part of one and of the floor. It stands too far away to block anything there.
  const Scene scene{{kFloor, Plane{.point = {0, 0, 0}, .normal = {1, 0, 0}},
                     Plane{.point = {1.5, 0, 0}, .normal = {1, 0, 0}},
                     parallelogram({0.15, -1.9, 1.2}, {0.4, 0, 0}, {0, 0.3, 0.5})}};
  Rendering rendering = render(scene, Shot::perspective({0.75, -3, 2.2}, {0.75, 0.5, 0}, 50, 320, 240));
  const HostFrame first = rendering.frame;
  add_solid_peels(rendering, scene, 1);
  const auto truth = [](const Hit& hit) -> std::optional<double> {
    if (hit.primitive != 0 || hit.position.y < -0.6 || hit.position.y > 0.6) return std::nullopt;
    return 1 - (segment(hit.position.x) + segment(1.5 - hit.position.x)) / kPi;
  };
  const double known = mean_error(rendering, rendering.frame, settings_of(1), truth);
  EXPECT_LE(known, 0.005);
  EXPECT_GT(mean_error(rendering, first, settings_of(1), truth), 1.3 * known);
}

/// Floor, wall, ball, a slab in the air and thin posts; seen from before them.
const Scene kFurniture = [] {
  Scene scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
               Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5},
               parallelogram({2, -1.5, 0.3}, {0.6, 0.2, 0.1}, {0, 0.9, 0})}};
  for (int i = 0; i < 6; i++)
    scene.primitives.emplace_back(parallelogram({2.5, 0.2 + 0.15 * i, 0}, {0, 0.03, 0}, {0, 0, 0.6}));
  return scene;
}();
const std::vector<int> kSolidFurniture = {2};

Rendering furnished(bool orthographic, int width = 160, int height = 120) {
  return render(kFurniture, orthographic ? Shot::orthographic({4.5, -1.5, 2.4}, {1, 0, 0.6}, 4, width, height)
                                         : Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, 55, width, height));
}

TEST(ExactHidden, outlines_give_what_every_pixel_gives) {
  for (const bool orthographic : {false, true}) {
    Rendering rendering = furnished(orthographic);
    add_solid_peels(rendering, kFurniture, 3, kSolidFurniture);
    for (const Completion complete : {Completion::none, Completion::border, Completion::all}) {
      if (!tried(orthographic + int(complete), 3)) continue;
      const std::vector<float> marched = run(rendering.frame, settings_of(0.6, complete, SliceSearch::every_pixel));
      const Difference d = difference(run(rendering.frame, settings_of(0.6, complete)), marched);
      EXPECT_LE(d.rmse, complete == Completion::all ? 0.006 : 0.003)
          << orthographic << ", complete " << int(complete) << ", " << place(d, rendering.frame);
      EXPECT_LE(std::abs(d.bias), 0.001);
    }
  }
}

TEST(ExactHidden, rays_confirm_what_is_known_of_a_furnished_room) {
  Rendering rendering = furnished(false);
  const HostFrame first = rendering.frame;
  add_solid_peels(rendering, kFurniture, 3, kSolidFurniture);
  const auto truth = [&](const Hit& hit) -> std::optional<double> {
    const bool is_sample = int(1000 * (hit.position.x + 7 * hit.position.y + 13 * hit.position.z)) % 5 == 0;
    return is_sample && hit.position.x < 3 ? std::optional(by_rays(kFurniture, hit, 0.6)) : std::nullopt;
  };
  const double known = mean_error(rendering, rendering.frame, settings_of(0.6, Completion::all), truth);
  const double guessed = mean_error(rendering, first, settings_of(0.6, Completion::all), truth);
  EXPECT_LE(known, 0.8 * guessed) << known << " and " << guessed;
}

/// Gives the frame a plane of fronts, and expects the bits that it has without.
void expect_no_change(HostFrame frame, const std::vector<float>& fronts, const char* what) {
  HostFrame with = frame;
  with.behind.push_back({BehindKind::fronts});
  with.behind_depth = fronts;
  for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant}) {
    for (const Completion complete : {Completion::none, Completion::border, Completion::all}) {
      // Where surfaces are known, widths make runs thinner, as where they are completed.
      if (thickness == ThicknessKind::automatic && complete == Completion::border) continue;
      EstimatorSettings settings = settings_of(0.6, complete);
      settings.thickness = thickness;
      settings.thickness_length = 0.2;
      EXPECT_TRUE(same_bits(run(with, settings), run(frame, settings)))
          << what << ", thickness " << int(thickness) << ", complete " << int(complete);
    }
  }
}

TEST(ExactHidden, copies_of_the_first_depth_change_no_bit) {
  const HostFrame frame = furnished(false).frame;
  expect_no_change(frame, frame.depth, "copies");
}

TEST(ExactHidden, surfaces_beyond_the_radius_change_no_bit) {
  for (const bool orthographic : {false, true}) {
    const HostFrame frame = furnished(orthographic, 96, 72).frame;
    std::vector<float> far;
    for (const float z : frame.depth) far.push_back(z < kSky ? 60 + z : kSky);
    expect_no_change(frame, far, orthographic ? "orthographic" : "perspective");
  }
}

TEST(ExactHidden, fronts_never_open_what_is_blocked) {
  // What touches another surface is taken for it where its own is hidden, so all of these hover.
  const Scene scene{{kFloor, parallelogram({0, -0.6, 0.5}, {0.8, 0, 0}, {0, 1, 0.2}),
                     parallelogram({0.4, -0.2, 1.1}, {0.7, 0.1, 0}, {0, 0.8, 0}),
                     Sphere{.center = {-0.6, 0.3, 0.8}, .radius = 0.3}}};
  Rendering rendering = render(scene, Shot::perspective({0.6, -2.4, 3}, {0.2, 0, 0.3}, 45, 160, 120));
  const EstimatorSettings settings = settings_of(0.9);
  const std::vector<float> first = run(rendering.frame, settings);
  add_solid_peels(rendering, scene, 3);
  const std::vector<float> all = run(rendering.frame, settings);
  double most = 0, least = 0;
  for (std::size_t i = 0; i < all.size(); i++) {
    most = std::max(most, double(all[i] - first[i]));
    least = std::min(least, double(all[i] - first[i]));
  }
  EXPECT_LE(most, 0.006);
  EXPECT_LT(least, -0.05);
}

TEST(ExactHidden, the_order_of_planes_changes_no_bit) {
  Rendering rendering = furnished(false);
  add_solid_peels(rendering, kFurniture, 3, kSolidFurniture);
  const EstimatorSettings settings = settings_of(0.6, Completion::all);
  const std::vector<float> ao = run(rendering.frame, settings);
  turn_solid_peels(rendering.frame);
  EXPECT_TRUE(same_bits(run(rendering.frame, settings), ao));
}

TEST(ExactHidden, a_known_back_ends_what_is_blocked) {
  // A slab in the air over a floor. Its width would be taken for its thickness.
  const Scene scene{{kFloor, parallelogram({0, -1, 0.6}, {0.5, 0, 0}, {0, 2, 0})}};
  Rendering rendering = render(scene, Shot::perspective({0.25, 0.2, 4}, {0.25, 0, 0}, 50, 160, 120));
  HostFrame& frame = rendering.frame;
  const std::vector<float> first = run(frame, settings_of(1));
  frame.behind.push_back({BehindKind::thickness});
  for (const Hit& hit : rendering.hits) frame.behind_depth.push_back(hit.primitive == 1 ? 0.02f : 0.0f);
  EstimatorSettings thin = settings_of(1);
  thin.separation = 0.001;
  const std::vector<float> known = run(frame, thin);
  EstimatorSettings constant = settings_of(1);
  constant.thickness = ThicknessKind::constant;
  constant.thickness_length = 0.02;
  const std::vector<float> expected = run(without_peels(frame), constant);
  double gained = 0;
  int receivers = 0;
  double off = 0;
  for (std::size_t i = 0; i < known.size(); i++) {
    const Hit& hit = rendering.hits[i];
    if (hit.primitive != 0 || std::abs(hit.position.y) > 0.5) continue;
    gained = std::max(gained, double(known[i] - first[i]));
    off += std::abs(known[i] - expected[i]);
    receivers++;
  }
  EXPECT_GT(gained, 0.05);
  EXPECT_LE(off / receivers, 0.003);
}

/// A wall at 5, and before its left part a board far before it. Behind that, up to column 40, a sheet at `sheet`, and
/// from there on one at 4.8 that goes on to column 60, beside the board.
HostFrame sheets_behind_board(float sheet) {
  constexpr int kWidth = 128, kHeight = 64;
  const Scene wall{{Plane{{0, 0, 0}, {0, 0, 1}}}};
  HostFrame frame = render(wall, Shot::orthographic({0, 0, 5}, {0, 0.001, 0}, 1.28, kWidth, kHeight)).frame;
  frame.behind.assign(1, {});
  frame.behind_depth.assign(std::size_t(kWidth * kHeight), 0);
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < 60; x++) {
      const auto i = std::size_t(y * kWidth + x);
      frame.depth[i] = x < 58 ? 4.5F : 4.8F;
      if (x < 58) frame.behind_depth[i] = x < 40 ? sheet : 4.8F;
    }
  return frame;
}

// Its pixels list as many surfaces as there are, so more may be behind them: what is seen goes on there, but not what
// is hidden itself.
TEST(ExactHidden, hidden_surfaces_do_not_go_on) {
  const EstimatorSettings settings = settings_of(0.3, Completion::all);  // 30 px
  const std::vector<float> near = run(sheets_behind_board(4.95F), settings);
  const std::vector<float> nearer = run(sheets_behind_board(4.9F), settings);
  for (std::size_t i = 0; i < near.size(); i++)
    if (i % 128 >= 72) EXPECT_EQ(near[i], nearer[i]) << i % 128 << " " << i / 128;
}

// From row to row its depth changes by as much as the two are apart, somewhere.
TEST(ExactHidden, a_floor_seen_aslant_is_open_above_its_underside) {
  const Shot shot = Shot::perspective({0, 0, 1.7}, {0, 10, 1}, 60, 160, 120);
  HostFrame frame = render(Scene{{kFloor}}, shot).frame;
  frame.behind.assign(1, {});
  frame.behind_depth = render(Scene{{Plane{.point = {0, 0, -0.1}, .normal = {0, 0, 1}}}}, shot).frame.depth;
  EstimatorSettings settings = settings_of(1);
  const std::vector<float> ao = run(frame, settings), alone = run(without_peels(frame), settings);
  int floor = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    if (frame.depth[i] > 60) continue;
    floor++;
    EXPECT_NEAR(ao[i], alone[i], 1e-3) << i % 160 << " " << i / 160 << " z " << frame.depth[i];
  }
  EXPECT_GT(floor, 5000);
}

TEST(ExactHidden, a_tolerance_comes_to_the_same) {
  Rendering rendering = furnished(false, 96, 72);
  add_solid_peels(rendering, kFurniture, 3, kSolidFurniture);
  EstimatorSettings all = settings_of(0.6, Completion::all), until = all;
  all.slices = 64;
  until.tolerance = 0.01;
  const std::vector<float> ao = run(rendering.frame, all);
  const Difference d = difference(run(rendering.frame, until), ao);
  EXPECT_LE(d.rmse, 0.02);
  until.tolerance = 1e-6;
  EXPECT_LE(difference(run(rendering.frame, until), ao).rmse, 1e-3);
}

TEST(ExactHidden, crops_have_the_bits_of_the_whole) {
  const Window whole{0, 0, 400, 300}, part{80, 60, 300, 220}, compared{160, 140, 140, 60};
  Rendering rendering = furnished(false, whole.width, whole.height);
  add_solid_peels(rendering, kFurniture, 3, kSolidFurniture);
  Shot shot = rendering.shot;
  shot.data = part;
  Rendering crop = render(kFurniture, shot);
  add_solid_peels(crop, kFurniture, 3, kSolidFurniture);
  const EstimatorSettings settings = settings_of(0.05);
  const std::vector<float> of_whole = run(rendering.frame, settings), of_part = run(crop.frame, settings);
  int different = 0;
  for (int y = compared.y; y < compared.y + compared.height; y++)
    for (int x = compared.x; x < compared.x + compared.width; x++)
      different +=
          of_whole[std::size_t(y * whole.width + x)] != of_part[std::size_t((y - part.y) * part.width + x - part.x)]
              ? 1
              : 0;
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace alcove
