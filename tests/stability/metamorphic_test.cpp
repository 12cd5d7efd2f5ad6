// What is the same scene has the same AO, for every estimator: other units, mirrors, crops, marks of sky, kinds of depth, projections; and what is more blocked is darker.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/device.h"
#include "tests/difference.h"
#include "tests/single_pass.h"
#include "tests/stability/cases.h"

namespace alcove {
namespace {

using namespace test;

constexpr double kRadius = 0.6;

std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) { return compute_ao(recorder(), frame, settings).ao; }

/// So many samples that what is left to see is the estimator.
EstimatorSettings converged(EstimatorSettings settings, double radius) {
  settings = with_radius(settings, radius);
  settings.slices = 16;
  settings.steps = 64;
  settings.samples = 64;
  return settings;
}

/// Those that a larger radius or another occluder can only darken: all that is seen is solid, and counts fully however far off.
std::vector<Variant> solid_estimators() {
  std::vector<Variant> all = estimators();
  for (auto& variant : all) {
    variant.settings.thickness = ThicknessKind::infinite;
    variant.settings.range_check = RangeCheck::none;
  }
  return all;
}

TEST(Metamorphic, scale_by_powers_of_two_changes_no_bit) {
  HostFrame frame = room(55, 1, 0, 40, 30).frame;
  for (const bool normals : {true, false}) {
    if (!normals) frame.normal.clear();
    for (const auto& variant : variants()) {
      EstimatorSettings settings = with_radius(variant.settings, kRadius);
      const std::vector<float> expected = run(frame, settings);
      const double bias = settings.bias;
      for (const int exponent : {-20, 7, 30}) {
        HostFrame other = scaled(frame, exponent);
        settings = with_radius(settings, std::ldexp(kRadius, exponent));
        if (settings.estimator == Estimator::crytek) settings.bias = std::ldexp(bias, exponent);  // scene units
        const std::vector<float> ao = run(other, settings);
        EXPECT_TRUE(same_bits(ao, expected)) << variant.name << " 2^" << exponent << (normals ? ": " : " without normals: ") << difference(ao, expected).max;
      }
    }
  }
}

// The noise isn't mirrored: two estimates of the same.
TEST(Metamorphic, a_mirrored_frame_has_the_mirrored_ao) {
  const HostFrame frame = room(55, 1, 0.1, 48, 36).frame;
  for (const auto& variant : estimators()) {
    const EstimatorSettings settings = converged(variant.settings, kRadius);
    const std::vector<float> upright = run(frame, settings);
    for (const bool left_right : {true, false}) {
      const Difference d = difference(run(mirrored(frame, left_right), settings), mirrored(upright, frame, left_right));
      EXPECT_LE(std::abs(d.bias), 2e-3) << variant.name << " " << left_right;
      EXPECT_LE(d.rmse, 0.02) << variant.name << " " << left_right;
    }
  }
}

TEST(Metamorphic, ao_of_a_crop_is_the_crop_of_ao) {
  constexpr double kSmall = 0.3;
  const Rendering whole = room(55, 1, 0, 96, 72);
  Shot shot = whole.shot;
  shot.data = {17, 11, 60, 50};
  Rendering part = whole;
  part.shot = shot;
  part.frame.data = shot.data;
  part.frame.depth = cropped(whole.frame.depth, whole.frame.data, shot.data);
  part.frame.normal = cropped(whole.frame.normal, whole.frame.data, shot.data);
  for (const auto& variant : solid_estimators()) {
    if (searches_exactly(variant.settings)) continue;  // its lines are the whole's only in a crop with a wider margin; exact_test has one
    const EstimatorSettings settings = with_radius(variant.settings, kSmall);
    const std::vector<float> of_whole = cropped(run(whole.frame, settings), whole.frame.data, shot.data), of_part = run(part.frame, settings);
    int compared = 0;
    for (std::size_t i = 0; i < of_part.size(); i++) {
      const Hit& hit = whole.at(shot.data.x + int(i) % shot.data.width, shot.data.y + int(i) / shot.data.width);
      if (hit.primitive < 0 || !shot.sees_ball(hit.position, kSmall)) continue;
      compared++;
      EXPECT_EQ(of_part[i], of_whole[i]) << variant.name << " pixel " << i;
    }
    EXPECT_GT(compared, 300);
  }
}

TEST(Metamorphic, any_mark_of_sky_is_sky) {
  const HostFrame frame = room(55, 1, 0, 40, 30).frame;
  constexpr float kLargest = std::numeric_limits<float>::max(), kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& variant : estimators()) {
    const EstimatorSettings settings = with_radius(variant.settings, kRadius);
    const std::vector<float> expected = run(frame, settings);
    for (const float mark : {0.0f, -0.0f, 1e9f, 1e10f, 1e30f, kLargest, kInfinity, -kInfinity, kNan, -1.0f, -kLargest}) {
      HostFrame marked = frame;
      std::ranges::replace(marked.depth, kSky, mark);
      EXPECT_TRUE(same_bits(run(marked, settings), expected)) << variant.name << " " << mark;
    }
  }
}

/// The frame's depth said in another way.
HostFrame said(const Rendering& rendering, DepthKind kind, bool reversed, double far) {
  HostFrame frame = rendering.frame;
  const double near = 0.5;
  frame.depth_kind = kind;
  frame.depth_range = {.near = near, .far = far, .reversed = reversed};
  for (std::size_t i = 0; i < frame.depth.size(); i++) {
    const Hit& hit = rendering.hits[i];
    const double z = hit.distance;
    double value = 0;
    switch (kind) {
      case DepthKind::ray: value = hit.primitive < 0 ? kSky : length(hit.position - rendering.shot.eye); break;
      case DepthKind::inverse: value = 1 / z; break;
      case DepthKind::device: value = (1 / near - 1 / z) / (1 / near - 1 / far); break;
      case DepthKind::normalized: value = (z - near) / (far - near); break;
      default: value = std::log1p(z) / std::log1p(far);
    }
    if (kind >= DepthKind::device) value = reversed ? 1 - std::min(value, 1.0) : std::min(value, 1.0);
    frame.depth[i] = float(value);
  }
  return frame;
}

// What differs is rounding, of depth to a few 1e-7; it may move a sample across the sphere of the radius.
TEST(Metamorphic, every_kind_of_depth_says_the_same) {
  const Rendering rendering = room(55, 1, 0, 48, 36);
  for (const auto& variant : estimators()) {
    const EstimatorSettings settings = with_radius(variant.settings, kRadius);
    const std::vector<float> planar = run(rendering.frame, settings);
    for (const DepthKind kind : {DepthKind::ray, DepthKind::inverse, DepthKind::device, DepthKind::normalized, DepthKind::log})
      for (const bool reversed : {false, true}) {
        if (reversed && kind < DepthKind::device) continue;
        const Difference d = difference(run(said(rendering, kind, reversed, 50), settings), planar);
        EXPECT_LE(d.rmse, 5e-3) << variant.name << " kind " << int(kind) << " reversed " << reversed;
        EXPECT_LE(std::abs(d.bias), 5e-4) << variant.name << " kind " << int(kind) << " reversed " << reversed;
      }
  }
}

TEST(Metamorphic, orthographic_is_the_limit_of_a_small_field_of_view) {
  const Rendering parallel = room(0, 1, 0, 48, 36), narrow = room(0.25, 1, 0, 48, 36);
  for (const auto& variant : estimators()) {
    const EstimatorSettings settings = converged(variant.settings, kRadius);
    const Difference d = difference(run(narrow.frame, settings), run(parallel.frame, settings));
    EXPECT_LE(d.rmse, 0.02) << variant.name << " " << place(d, narrow.frame);
    EXPECT_LE(std::abs(d.bias), 2e-3) << variant.name;
  }
}

// Where a surface leaves the sphere between two samples is interpolated, so a pixel may be off by a little. Crytek's samples move as the radius grows.
TEST(Metamorphic, a_larger_radius_only_darkens) {
  const HostFrame frame = room(55, 1, 0, 48, 36).frame;
  for (const auto& variant : solid_estimators()) {
    if (variant.settings.estimator == Estimator::crytek) continue;
    std::vector<float> smaller(frame.data.pixels(), 1.0f);
    for (const double radius : {1e-9, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 1e9}) {
      EstimatorSettings settings = converged(variant.settings, radius);
      const std::vector<float> ao = run(frame, settings);
      for (std::size_t i = 0; i < ao.size(); i++) EXPECT_LE(ao[i], smaller[i] + 0.02) << variant.name << " radius " << radius << " pixel " << i;
      EXPECT_LE(difference(ao, smaller).bias, 0) << variant.name << " radius " << radius;
      smaller = ao;
    }
  }
}

// With an endless radius: within one, what comes before a blocker may be out of reach itself. Bits are counted with a random shift, the same in both frames.
TEST(Metamorphic, an_added_occluder_never_brightens_what_is_still_seen) {
  const Plane floor{.point = {}, .normal = {0, 0, 1}}, wall{.point = {}, .normal = {1, 0, 0}};
  const Sphere ball{.center = {1.5, 0.2, 0.8}, .radius = 0.3};
  const Shot shot = Shot::perspective({4, -1, 3}, {0.8, 0, 0.4}, 55, 64, 48);
  const Rendering without = render({{floor, wall}}, shot), with = render({{floor, wall, ball}}, shot);
  for (const auto& variant : solid_estimators()) {
    EstimatorSettings settings = converged(variant.settings, 100);
    if (variant.settings.estimator == Estimator::crytek) settings.radius = 1;
    const std::vector<float> before = run(without.frame, settings), after = run(with.frame, settings);
    int same = 0, darker = 0;
    for (std::size_t i = 0; i < before.size(); i++) {
      if (with.hits[i].primitive != without.hits[i].primitive) continue;
      same++;
      darker += after[i] < before[i] - 0.01f;
      EXPECT_LE(after[i], before[i] + 1e-5f) << variant.name << " pixel " << i;
    }
    EXPECT_GT(same, 2000);
    EXPECT_GT(darker, 20) << variant.name;
  }
}

TEST(Metamorphic, a_convex_body_alone_is_open) {
  const Sphere ball{.center = {6, 0.4, -0.3}, .radius = 1.5};
  const Plane plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})};
  for (const Scene& scene : {Scene{{ball}}, Scene{{plane}}})
    for (const double fov : {0.0, 0.5, 20.0, 90.0, 150.0, 170.0}) {
      const Shot shot = fov > 0 ? Shot::perspective({}, {1, 0, 0}, fov, 48, 36) : Shot::orthographic({}, {1, 0, 0}, 5, 48, 36);
      const HostFrame frame = render(scene, shot).frame;
      for (const auto& variant : estimators())
        for (const double radius : {1e-6, 0.05, 1.0, 1e6}) {
          const Difference d = difference(run(frame, with_radius(variant.settings, radius)), [](std::size_t) { return 1.0; });
          // The strokes of an exact search keep to the surface within a fifth of a pixel, which is most at the rim of a ball.
          EXPECT_LE(d.max, searches_exactly(variant.settings) ? 0.01 : 1e-4) << variant.name << " fov " << fov << " radius " << radius << " " << place(d, frame);
        }
    }
}

// To 89.99 degrees. From 85 on a pixel's own footprint is longer than the radius, and rounded normals (4e-5 rad) tilt the plane by part of what is left.
TEST(Metamorphic, a_plane_at_a_grazing_angle_is_open) {
  for (const double tilt : {60.0, 85.0, 89.0, 89.9, 89.99})
    for (const double turn : {0.0, 37.0, 90.0, 200.0}) {
      const double t = tilt * std::numbers::pi / 180, u = turn * std::numbers::pi / 180;
      const Plane plane{.point = {60, 0, 0}, .normal = {-std::cos(t), std::sin(t) * std::cos(u), std::sin(t) * std::sin(u)}};
      for (const double fov : {0.0, 0.01, 60.0}) {
        const Shot shot = fov > 0 ? Shot::perspective({}, {1, 0, 0}, fov, 48, 36) : Shot::orthographic({}, {1, 0, 0}, 0.01, 48, 36);
        const HostFrame frame = render({{plane}}, shot).frame;
        for (const auto& variant : estimators())
          for (const double radius : {0.05, 1.0, 1e6}) {
            const Difference d = difference(run(frame, with_radius(variant.settings, radius)), [](std::size_t) { return 1.0; });
            EXPECT_LE(d.max, searches_exactly(variant.settings) ? 3e-3 : 1e-3) << variant.name << " tilt " << tilt << " turn " << turn << " fov " << fov << " radius " << radius << " " << place(d, frame);
          }
      }
    }
}

}  // namespace
}  // namespace alcove
