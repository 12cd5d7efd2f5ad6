// What must hold of the AO whatever the scene: invariances, limits, repairs, odd sizes.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/chain/compute.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/furnished.h"
#include "tests/support/scenes.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using test::Difference, test::difference, test::place, test::same_bits;
using test::Plane, test::Rendering, test::Scene, test::Shot, test::Sphere, test::unit, test::Vec3;

constexpr double kRadian = std::numbers::pi / 180;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
const Vec3 kForward{1, 0, 0};  // where the cameras of flat scenes look

EstimatorSettings settings_of(double radius, int slices, int steps) {
  EstimatorSettings settings = test::plain_settings();
  settings.radius = radius;
  settings.slices = slices;
  settings.steps = steps;
  return settings;
}

HostResult run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(test::recorder(), frame, settings);
}

void expect_open(const HostFrame& frame, const EstimatorSettings& settings, double tolerance, const std::string& what) {
  const HostResult result = run(frame, settings);
  const Difference d = difference(result.ao, [](std::size_t) { return 1.0; });
  EXPECT_LE(d.max, tolerance) << what << ", " << settings.slices << " x " << settings.steps << ", radius "
                              << *settings.radius << ", " << place(d, frame);
}

Rendering furnished(int width = 160, int height = 120) { return test::furnished_room(width, height); }

/// A floor, a wall without end, and a dome.
Scene room_with_a_dome() {
  return {{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}},
           Sphere{.center = {1, 0.5, -0.2}, .radius = 0.5}}};
}

/// The frame whose pixel (x, y) is the pixel `source(x, y)` of another, both counted from their data windows' corners.
HostFrame rearranged(const HostFrame& frame, const Window& data,
                     const std::function<std::pair<int, int>(int, int)>& source) {
  HostFrame result = frame;
  const std::size_t pixels = data.pixels(), from_pixels = frame.data.pixels();
  result.data = data;
  result.depth.resize(pixels);
  result.normal.resize(frame.normal.empty() ? 0 : 3 * pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const auto [x, y] = source(int(i % std::size_t(data.width)), int(i / std::size_t(data.width)));
    const std::size_t from = std::size_t(y) * std::size_t(frame.data.width) + std::size_t(x);
    result.depth[i] = frame.depth[from];
    for (std::size_t axis = 0; axis < result.normal.size() / pixels; axis++)
      result.normal[i + axis * pixels] = frame.normal[from + axis * from_pixels];
  }
  return result;
}

// Flat and convex surfaces.

TEST(FlatPlane, is_open_at_every_tilt_and_field_of_view) {
  const std::vector<EstimatorSettings> all{settings_of(100, 1, 1), settings_of(0.5, 2, 3), settings_of(0.002, 3, 6),
                                           settings_of(3, 3, 6), settings_of(1e5, 8, 40)};
  for (const double tilt : {0.0, 30.0, 60.0, 80.0, 85.0}) {
    for (const double turn : {0.0, 37.0, 90.0, 200.0}) {
      const double sine = std::sin(tilt * kRadian);
      const Vec3 normal{-std::cos(tilt * kRadian), sine * std::cos(turn * kRadian), sine * std::sin(turn * kRadian)};
      const Scene scene{{Plane{.point = {5, 0, 0}, .normal = normal}}};
      for (const double fov : {0.0, 10.0, 60.0, 90.0, 120.0}) {
        const Shot shot =
            fov > 0 ? Shot::perspective({}, kForward, fov, 64, 48) : Shot::orthographic({}, kForward, 0.5, 64, 48);
        const std::string what =
            "tilt " + std::to_string(tilt) + " turn " + std::to_string(turn) + " fov " + std::to_string(fov);
        const Rendering rendering = test::render(scene, shot);
        for (const EstimatorSettings& settings : all) expect_open(rendering.frame, settings, 1e-4, what);
      }
    }
  }
}

TEST(FlatPlane, is_open_with_every_falloff_at_a_full_size) {
  const Scene scene{{Plane{.point = {5, 0, 0}, .normal = unit({-0.3, 0.2, 1})}}};
  const Rendering rendering = test::render(scene, Shot::perspective({}, kForward, 75, 320, 240));
  for (const Falloff falloff : {Falloff::none, Falloff::linear, Falloff::quadratic, Falloff::smooth}) {
    EstimatorSettings settings = settings_of(2, 4, 16);
    settings.falloff = falloff;
    settings.falloff_start = 0.3;
    expect_open(rendering.frame, settings, 1e-4, "falloff " + std::to_string(int(falloff)));
  }
}

TEST(FlatPlane, is_open_through_a_shifted_lens_and_oblong_pixels) {
  Shot shot = Shot::perspective({}, kForward, 80, 96, 64);
  shot.camera.cx += 70.3;
  shot.camera.cy -= 45.1;
  shot.camera.fy *= 1.7;
  const Rendering rendering = test::render({{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.6, -0.8})}}}, shot);
  for (const double radius : {0.1, 2.0, 1e3}) expect_open(rendering.frame, settings_of(radius, 3, 20), 1e-4, "shifted");
}

TEST(FlatPlane, is_open_without_normals) {
  for (const double tilt : {0.0, 45.0, 75.0}) {
    for (const double fov : {0.0, 60.0, 100.0}) {
      const double sine = std::sin(tilt * kRadian);
      const Scene scene{{Plane{.point = {5, 0, 0}, .normal = unit({-std::cos(tilt * kRadian), 0.4 * sine, sine})}}};
      const Shot shot =
          fov > 0 ? Shot::perspective({}, kForward, fov, 96, 72) : Shot::orthographic({}, kForward, 5, 96, 72);
      Rendering rendering = test::render(scene, shot);
      rendering.frame.normal.clear();
      const std::string what = "tilt " + std::to_string(tilt) + " fov " + std::to_string(fov);
      for (const double radius : {0.3, 3.0, 1e3}) expect_open(rendering.frame, settings_of(radius, 3, 12), 1e-3, what);
      EXPECT_EQ(run(rendering.frame, settings_of(1, 3, 6)).repaired_normals, 0u) << "nothing was there to repair";
    }
  }
}

TEST(ConvexBody, is_open_before_the_sky) {
  const Sphere ball{.center = {6, 0.4, -0.3}, .radius = 1.5};
  const Vec3 a = 1.6 * unit({1, 0.5, 0.3}), b = 1.2 * unit(cross(a, {0, 0, 1})), c = 1.4 * unit(cross(a, b)),
             corner{5, -0.5, 0.3};
  const Scene box{{test::parallelogram(corner, a, b), test::parallelogram(corner, b, c),
                   test::parallelogram(corner, c, a), test::parallelogram(corner + c, a, b),
                   test::parallelogram(corner + a, b, c), test::parallelogram(corner + b, c, a)}};
  for (const auto& [name, scene] : {std::pair<const char*, Scene>{"ball", {{ball}}}, {"box", box}}) {
    for (const Shot& shot : {Shot::perspective({}, kForward, 50, 160, 120),
                             Shot::perspective({2.5, 0, 0}, kForward + Vec3{4, 1, 0}, 110, 160, 120),
                             Shot::orthographic({}, kForward, 5, 160, 120)}) {
      const Rendering rendering = test::render(scene, shot);
      ASSERT_GT(std::ranges::count_if(rendering.hits, [](const test::Hit& hit) { return hit.primitive >= 0; }), 1000)
          << name;
      for (const auto& settings : {settings_of(0.2, 3, 6), settings_of(2, 2, 3), settings_of(100, 8, 64)})
        expect_open(rendering.frame, settings, 1e-4, name);
    }
  }
}

// Symmetries of space.

TEST(Scale, by_powers_of_two_changes_no_bit) {
  const Rendering rendering = furnished();
  for (const Falloff falloff : {Falloff::none, Falloff::smooth}) {
    EstimatorSettings settings = settings_of(0.6, 3, 12);
    settings.falloff = falloff;
    settings.falloff_start = 0.25;
    const std::vector<float> expected = run(rendering.frame, settings).ao;
    for (const int exponent : {-20, -3, 1, 10, 24}) {
      HostFrame scaled = rendering.frame;
      for (float& z : scaled.depth) z = std::ldexp(z, exponent);
      scaled.sky = std::ldexp(scaled.sky, exponent);
      EstimatorSettings scaled_settings = settings;
      scaled_settings.radius = std::ldexp(*settings.radius, exponent);
      const std::vector<float> ao = run(scaled, scaled_settings).ao;
      EXPECT_TRUE(same_bits(ao, expected)) << "2^" << exponent << ": max difference " << difference(ao, expected).max;
    }
  }
}

TEST(Scale, of_depth_by_its_setting_is_that_of_the_file) {
  const Rendering rendering = furnished();
  HostFrame centimetres = rendering.frame;
  for (float& z : centimetres.depth) z *= 128;
  centimetres.depth_scale = 1.0 / 128;
  centimetres.sky *= 128;
  EXPECT_TRUE(same_bits(run(centimetres, settings_of(0.6, 3, 6)).ao, run(rendering.frame, settings_of(0.6, 3, 6)).ao));
}

// The noise isn't mirrored, so the two are two estimates of the same; each is within 0.02 of the truth with so many
// samples, 0.005 in the mean.
TEST(Mirror, of_the_frame_is_the_mirror_of_the_ao) {
  Shot shot = Shot::perspective({4, -1, 3}, {0.8, 0, 0.4}, 55, 160, 120);
  shot.camera.cx -= 20;
  shot.camera.cy += 11;
  const Scene scene = room_with_a_dome();
  const HostFrame frame = test::render(scene, shot).frame;
  const int width = frame.data.width, height = frame.data.height;
  const std::size_t pixels = frame.data.pixels();
  const EstimatorSettings settings = settings_of(1, 32, 64);
  const std::vector<float> upright = run(frame, settings).ao;
  for (const bool flip_x : {true, false}) {
    const auto source = [&](int x, int y) {
      return flip_x ? std::pair{width - 1 - x, y} : std::pair{x, height - 1 - y};
    };
    HostFrame flipped = rearranged(frame, frame.data, source);
    for (std::size_t i = 0; i < pixels; i++) flipped.normal[i + (flip_x ? 0 : pixels)] *= -1;
    (flip_x ? flipped.camera.cx : flipped.camera.cy) = flip_x ? width - frame.camera.cx : height - frame.camera.cy;
    const Difference d = difference(run(flipped, settings).ao, [&](std::size_t i) {
      const auto [x, y] = source(int(i) % width, int(i) / width);
      return double(upright[std::size_t(y * width + x)]);
    });
    EXPECT_LE(d.max, 0.04) << "flip " << (flip_x ? "x, " : "y, ") << place(d, flipped);
    EXPECT_LE(d.mean, 0.01) << "flip " << (flip_x ? "x" : "y");
    EXPECT_LE(std::abs(d.bias), 1e-3) << "flip " << (flip_x ? "x" : "y");
  }
}

TEST(Projection, orthographic_is_the_limit_of_a_small_field_of_view) {
  const Scene scene = room_with_a_dome();
  const Vec3 target{0.6, 0, 0.3}, towards = unit({4, -1, 3});
  const double distance = 500, width = 4;
  const EstimatorSettings settings = settings_of(0.8, 8, 32);
  const Rendering near = test::render(scene, Shot::orthographic(target + 10 * towards, target, width, 160, 120));
  const double fov = 2 * std::atan(0.5 * width / distance) / kRadian;
  const Rendering far = test::render(scene, Shot::perspective(target + distance * towards, target, fov, 160, 120));
  // An edge may move by a pixel, and a sample in or out of the radius.
  const Difference d = difference(run(far.frame, settings).ao, run(near.frame, settings).ao);
  EXPECT_LE(d.mean, 1e-3) << place(d, far.frame);
  EXPECT_LE(d.max, 0.05) << place(d, far.frame);  // one sample that falls on the other side of an edge
}

// Kinds of input that mean the same.

TEST(DepthKind, planar_ray_and_inverse_agree) {
  const Rendering rendering = furnished();
  const auto kinds = [&](DepthKind kind) {
    HostFrame frame = rendering.frame;
    frame.depth_kind = kind;
    for (std::size_t i = 0; i < frame.depth.size(); i++) {
      const test::Hit& hit = rendering.hits[i];
      if (kind == DepthKind::ray && hit.primitive >= 0)
        frame.depth[i] = float(length(hit.position - rendering.shot.eye));
      if (kind == DepthKind::inverse) frame.depth[i] = hit.primitive < 0 ? 0 : float(1 / hit.distance);
    }
    return frame;
  };
  // With no radius to fall in or out of, every pixel agrees; with one, rounding may move single samples across it.
  for (const double radius : {1e3, 0.6}) {
    const std::vector<float> planar = run(rendering.frame, settings_of(radius, 3, 12)).ao;
    for (const DepthKind kind : {DepthKind::ray, DepthKind::inverse}) {
      const HostFrame frame = kinds(kind);
      const HostResult result = run(frame, settings_of(radius, 3, 12));
      const Difference d = difference(result.ao, planar);
      EXPECT_LE(radius > 1 ? d.max : d.rmse, 1e-4)
          << "kind " << int(kind) << " radius " << radius << " max " << d.max << ", " << place(d, frame);
      EXPECT_EQ(result.sky_pixels, run(rendering.frame, settings_of(radius, 1, 1)).sky_pixels) << "kind " << int(kind);
      EXPECT_EQ(result.repaired_depth, 0u) << "kind " << int(kind);
    }
  }
}

TEST(NormalSpace, world_normals_are_turned_into_view_space) {
  const Rendering rendering = furnished();
  HostFrame world = rendering.frame;
  const std::size_t pixels = world.data.pixels();
  const Shot& shot = rendering.shot;
  world.normal_space = NormalSpace::world;
  const auto row = [](Vec3 v) { return std::array{v.x, v.y, v.z}; };
  world.camera.view_from_world = Matrix3{row(shot.right), row(shot.up), row(shot.back)};
  for (std::size_t i = 0; i < pixels; i++) {
    const Vec3 n = rendering.hits[i].normal;
    world.normal[i] = float(n.x), world.normal[i + pixels] = float(n.y), world.normal[i + 2 * pixels] = float(n.z);
  }
  const Difference d =
      difference(run(world, settings_of(0.6, 3, 12)).ao, run(rendering.frame, settings_of(0.6, 3, 12)).ao);
  EXPECT_LE(d.max, 1e-4) << place(d, world);
}

TEST(Sky, is_the_same_whatever_marks_it) {
  const Rendering rendering = furnished();
  const EstimatorSettings settings = settings_of(0.6, 3, 6);
  const HostResult expected = run(rendering.frame, settings);
  const auto sky =
      std::uint32_t(std::ranges::count_if(rendering.hits, [](const test::Hit& hit) { return hit.primitive < 0; }));
  ASSERT_GT(sky, 1000u);
  EXPECT_EQ(expected.sky_pixels, sky);
  EXPECT_EQ(expected.repaired_depth, 0u);
  constexpr float kLargest = std::numeric_limits<float>::max();
  for (const float mark :
       {0.0f, -0.0f, 1e9f, 1e30f, kLargest, kInfinity, kNan, -kNan, -1.0f, -1e30f, -kInfinity, 65504.0f}) {
    HostFrame frame = rendering.frame;
    std::ranges::replace(frame.depth, test::kSky, mark);
    if (mark == 65504) frame.sky = 65504;
    const HostResult result = run(frame, settings);
    EXPECT_TRUE(same_bits(result.ao, expected.ao))
        << mark << ": max difference " << difference(result.ao, expected.ao).max;
    EXPECT_EQ(result.sky_pixels, sky) << mark;
    EXPECT_EQ(result.repaired_depth, std::isnan(mark) || mark < 0 ? sky : 0u) << mark;
  }
}

TEST(Sky, is_open_and_hides_its_normals) {
  Rendering rendering = furnished();
  const std::vector<float> expected = run(rendering.frame, settings_of(0.6, 3, 6)).ao;
  const std::size_t pixels = rendering.frame.data.pixels();
  for (std::size_t i = 0; i < pixels; i++) {
    if (rendering.hits[i].primitive >= 0) continue;
    EXPECT_EQ(expected[i], 1.0f) << i;
    rendering.frame.normal[i] = rendering.frame.normal[i + pixels] = kNan;
  }
  const HostResult result = run(rendering.frame, settings_of(0.6, 3, 6));
  EXPECT_TRUE(same_bits(result.ao, expected));
  EXPECT_EQ(result.repaired_normals, 0u);
}

TEST(Sky, alone_is_open) {
  HostFrame frame = furnished().frame;
  std::ranges::fill(frame.depth, test::kSky);
  const HostResult result = run(frame, settings_of(1, 3, 6));
  EXPECT_TRUE(std::ranges::all_of(result.ao, [](float ao) { return ao == 1; }));
  EXPECT_EQ(result.sky_pixels, frame.data.pixels());
}

// Normals of every quality.

TEST(Normals, of_any_length_are_directions) {
  const Rendering rendering = furnished();
  const std::vector<float> expected = run(rendering.frame, settings_of(0.6, 3, 12)).ao;
  for (const float factor : {2.0f, 0.125f, 3.0f, 1e-3f, 1e6f}) {
    HostFrame frame = rendering.frame;
    for (float& n : frame.normal) n *= factor;
    const HostResult result = run(frame, settings_of(0.6, 3, 12));
    const Difference d = difference(result.ao, expected);
    EXPECT_LE(d.max, 1e-4) << factor << ", " << place(d, frame);
    EXPECT_EQ(result.repaired_normals, 0u) << factor;
  }
}

TEST(Normals, that_are_no_direction_are_reconstructed_and_counted) {
  const Scene scene{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})}}};
  const Rendering rendering = test::render(scene, Shot::perspective({}, kForward, 60, 80, 60));
  const std::size_t pixels = rendering.frame.data.pixels();
  for (const float bad : {0.0f, kNan, kInfinity, -kInfinity}) {
    HostFrame frame = rendering.frame;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < pixels; i += 3, count++)
      for (std::size_t axis = 0; axis < 3; axis++) frame.normal[i + axis * pixels] = bad;
    for (const double radius : {0.5, 100.0}) {
      const HostResult result = run(frame, settings_of(radius, 3, 12));
      const Difference d = difference(result.ao, [](std::size_t) { return 1.0; });
      EXPECT_LE(d.max, 1e-3) << bad << ", " << place(d, frame);
      EXPECT_EQ(result.repaired_normals, count) << bad;
    }
  }
}

TEST(Normals, of_the_other_side_are_turned_round) {
  const Rendering rendering = test::furnished();
  const auto right = run(rendering.frame, settings_of(1, 3, 6));
  EXPECT_EQ(right.turned_normals, 0u);
  const std::size_t pixels = rendering.frame.data.pixels();
  for (const int thing : {0, 1, 2}) {  // the floor, the wall, the ball
    HostFrame frame = rendering.frame;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < pixels; i++) {
      if (rendering.hits[i].primitive != thing) continue;
      for (std::size_t axis = 0; axis < 3; axis++) frame.normal[i + axis * pixels] *= -1;
      count++;
    }
    const auto turned = run(frame, settings_of(1, 3, 6));
    // A pixel between two edges has no neighbour of its own surface that would show how it lies.
    EXPECT_GE(turned.turned_normals, count - count / 1000) << thing;
    EXPECT_LE(turned.turned_normals, count) << thing;
    EXPECT_LE(difference(turned.ao, right.ao).rmse, 5e-3) << thing;
  }
}

TEST(Normals, that_lean_beyond_the_horizon_are_not_turned) {
  const Scene scene{{Plane{.point = {0, 0, -1}, .normal = {0, 0, 1}}}};
  const Rendering rendering = test::render(scene, Shot::perspective({}, unit(Vec3{1, 0, -0.1}), 60, 80, 60));
  HostFrame frame = rendering.frame;
  const std::size_t pixels = frame.data.pixels();
  std::size_t away = 0;
  for (std::size_t i = 0; i < pixels; i++) {
    if (rendering.hits[i].primitive < 0) continue;
    const Vec3 p = rendering.hits[i].position;
    const Vec3 n = unit(Vec3{0.6 * std::sin(7 * p.x), 0.6 * std::cos(5 * p.y), 1});
    const Vec3 v = rendering.shot.view_from_world(n);
    const float view[] = {float(v.x), float(v.y), float(v.z)};
    for (std::size_t axis = 0; axis < 3; axis++) frame.normal[i + axis * pixels] = view[axis];
    away += dot(n, p) > 0;
  }
  ASSERT_GT(away, pixels / 20) << "they lean away by up to 31 degrees";
  ASSERT_EQ(frame.normal_space, NormalSpace::view);
  EXPECT_EQ(run(frame, settings_of(1, 3, 6)).turned_normals, 0u);
}

TEST(Normals, with_one_bad_component_are_reconstructed) {
  const Scene scene{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})}}};
  HostFrame frame = test::render(scene, Shot::perspective({}, kForward, 60, 80, 60)).frame;
  frame.normal[40 * 80 + 30] = kNan;
  frame.normal[frame.data.pixels() + 20 * 80 + 10] = kInfinity;
  const HostResult result = run(frame, settings_of(1, 3, 6));
  EXPECT_EQ(result.repaired_normals, 2u);
  EXPECT_LE(difference(result.ao, [](std::size_t) { return 1.0; }).max, 1e-3);
}

TEST(Normals, of_every_direction_give_an_ao_from_0_to_1) {
  HostFrame frame = furnished().frame;
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (float& n : frame.normal) n = normal(random);
  for (const auto& settings : {settings_of(0.02, 1, 1), settings_of(0.6, 3, 6), settings_of(1e3, 2, 30)})
    for (const float ao : run(frame, settings).ao) ASSERT_TRUE(ao >= 0 && ao <= 1) << ao;
}

TEST(Depth, of_any_bits_gives_an_ao_from_0_to_1) {
  HostFrame frame = furnished().frame;
  std::mt19937 random(11);
  for (float& z : frame.depth) z = std::bit_cast<float>(std::uint32_t(random()));
  for (const bool normals : {true, false}) {
    if (!normals) frame.normal.clear();
    for (const DepthKind kind : {DepthKind::planar, DepthKind::ray, DepthKind::inverse}) {
      frame.depth_kind = kind;
      for (const float ao : run(frame, settings_of(0.6, 3, 6)).ao)
        ASSERT_TRUE(ao >= 0 && ao <= 1) << ao << " kind " << int(kind);
    }
  }
}

// Windows, sizes and repetition.

TEST(Crop, then_ao_is_ao_then_crop) {
  Rendering rendering = furnished(192, 144);
  const double radius = 0.4;
  const std::vector<float> whole = run(rendering.frame, settings_of(radius, 3, 12)).ao;
  Shot cropped = rendering.shot;
  cropped.data = {37, 21, 110, 93};
  const HostFrame frame = rearranged(rendering.frame, cropped.data, [&](int x, int y) {
    return std::pair{x + cropped.data.x, y + cropped.data.y};
  });
  const std::vector<float> ao = run(frame, settings_of(radius, 3, 12)).ao;
  int compared = 0;
  for (int y = 0; y < cropped.data.height; y++) {
    for (int x = 0; x < cropped.data.width; x++) {
      const test::Hit& hit = rendering.at(x + cropped.data.x, y + cropped.data.y);
      if (hit.primitive < 0 || !cropped.sees_ball(hit.position, radius)) continue;
      compared++;
      const float expected = whole[std::size_t((y + cropped.data.y) * 192 + x + cropped.data.x)];
      EXPECT_EQ(ao[std::size_t(y * cropped.data.width + x)], expected) << x << " " << y;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(Crop, of_overscan_is_the_frame_without) {
  const double radius = 0.3;
  Rendering rendering = furnished();
  Shot wide = rendering.shot;
  wide.data = {-24, -16, 208, 152};
  const Scene scene{{Plane{.point = {}, .normal = {0, 0, 1}}, Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
  const Rendering inside = test::render(scene, rendering.shot), overscan = test::render(scene, wide);
  const std::vector<float> expected = run(inside.frame, settings_of(radius, 3, 12)).ao,
                           ao = run(overscan.frame, settings_of(radius, 3, 12)).ao;
  int compared = 0;
  for (int y = 0; y < 120; y++) {
    for (int x = 0; x < 160; x++) {
      const test::Hit& hit = inside.at(x, y);
      if (hit.primitive < 0 || !inside.shot.sees_ball(hit.position, radius)) continue;
      compared++;
      EXPECT_EQ(ao[std::size_t((y + 16) * 208 + x + 24)], expected[std::size_t(y * 160 + x)]) << x << " " << y;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(Repetition, gives_the_same_bits) {
  const HostFrame frame = furnished().frame;
  const std::vector<float> once = run(frame, settings_of(0.6, 3, 6)).ao;
  run(furnished(31, 17).frame, settings_of(2, 1, 1));
  EXPECT_TRUE(same_bits(run(frame, settings_of(0.6, 3, 6)).ao, once));
}

TEST(Size, may_be_anything_from_one_pixel) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 5}, {8, 8}, {9, 7}, {17, 31}, {1, 700}, {700, 1}}) {
    const Scene scene{{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})}}};
    HostFrame frame = test::render(scene, Shot::perspective({}, kForward, 40, width, height)).frame;
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    expect_open(frame, settings_of(1, 3, 6), 1e-4, size);
    const Rendering rendering = furnished(width, height);
    for (const double radius : {0.6, 1e3})
      for (const float ao : run(rendering.frame, settings_of(radius, 3, 6)).ao)
        EXPECT_TRUE(ao >= 0 && ao <= 1) << size << ": " << ao;
    if (width < 3 || height < 3) continue;
    frame.normal.clear();
    expect_open(frame, settings_of(1, 3, 6), 1e-3, size + " without normals");
  }
}

// The radius.

TEST(Radius, only_darkens_as_it_grows) {
  // More steps than pixels: a larger radius sees all samples that a smaller one sees.
  // Where a surface leaves the sphere between two samples is interpolated, so a pixel may be off by a little.
  constexpr float kCrossing = 0.01f;
  const HostFrame frame = furnished().frame;
  std::vector<float> smaller = run(frame, settings_of(1e-4, 4, 256)).ao;
  for (const double radius : {0.01, 0.05, 0.2, 0.5, 1.0, 2.0, 5.0, 100.0}) {
    const std::vector<float> ao = run(frame, settings_of(radius, 4, 256)).ao;
    for (std::size_t i = 0; i < ao.size(); i++)
      ASSERT_LE(ao[i], smaller[i] + kCrossing) << "radius " << radius << " pixel " << i % 160 << " " << i / 160;
    EXPECT_LE(difference(ao, smaller).bias, 0) << "radius " << radius;
    smaller = ao;
  }
}

TEST(Radius, below_a_pixel_is_open) {
  const HostFrame frame = furnished().frame;
  expect_open(frame, settings_of(1e-4, 3, 6), 0, "sub-pixel");
}

TEST(Radius, of_few_pixels_darkens_a_crease) {
  const Scene scene{{Plane{.point = {}, .normal = {0, 0, 1}}, Plane{.point = {}, .normal = {1, 0, 0}}}};
  const HostFrame frame = test::render(scene, Shot::perspective({4, 0, 4}, {}, 30, 80, 60)).frame;
  const std::vector<float> ao = run(frame, settings_of(0.2, 3, 6)).ao;
  EXPECT_LT(*std::ranges::min_element(ao), 0.7f);
}

// Shaping.

TEST(Shape, raises_the_visibility_to_a_power_after_scaling_the_occlusion) {
  const HostFrame frame = furnished().frame;
  const std::vector<float> plain = run(frame, settings_of(0.6, 3, 6)).ao;
  EstimatorSettings settings = settings_of(0.6, 3, 6);
  settings.intensity = 1.5;
  settings.power = 1.3;
  const Difference d = difference(
      run(frame, settings).ao, [&](std::size_t i) { return std::pow(std::max(0.0, 1 - 1.5 * (1 - plain[i])), 1.3); });
  EXPECT_LE(d.max, 1e-5) << place(d, frame);
}

}  // namespace
}  // namespace alcove
