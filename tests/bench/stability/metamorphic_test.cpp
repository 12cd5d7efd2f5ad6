// What is the same scene has the same AO, for every estimator: mirrors, projections; and what is more blocked is
// darker. Other units and crops: tests/chain/property_test.cpp; kinds of depth and marks of sky:
// tests/frame/inputs_test.cpp.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/compute.h"
#include "core/chain/estimate/estimate.h"
#include "tests/bench/stability/cases.h"
#include "tests/support/chain.h"

namespace alcove::metamorphic_test {
namespace {

using namespace test;

constexpr double kRadius = 0.6;

/// So many samples that what is left to see is the estimator.
EstimatorSettings converged(EstimatorSettings settings, double radius) {
  settings = with_radius(settings, radius);
  settings.slices = 16;
  settings.steps = 64;
  settings.samples = 64;
  return settings;
}

/// Those that a larger radius or another occluder can only darken: all that is seen is solid, and counts fully however
/// far off.
std::vector<Variant> solid_estimators() {
  std::vector<Variant> all;
  for (Variant variant : estimators()) {
    if (variant.name == "gtao infinite" || variant.name == "gtao constant") continue;  // which is then gtao
    variant.settings.thickness = ThicknessKind::infinite;
    variant.settings.range_check = RangeCheck::none;
    all.push_back(variant);
  }
  return all;
}

// The noise isn't mirrored: two estimates of the same.
TEST(Metamorphic, a_mirrored_frame_has_the_mirrored_ao) {
  const HostFrame frame = room(55, 1, 0.1, 48, 36).frame;
  for (const auto& variant : estimators()) {
    const EstimatorSettings settings = converged(variant.settings, kRadius);
    const std::vector<float> upright = ao_of(frame, settings);
    for (const bool left_right : {true, false}) {
      const Difference d =
          difference(ao_of(mirrored(frame, left_right), settings), mirrored(upright, frame, left_right));
      EXPECT_LE(std::abs(d.bias), 1e-3) << variant.name << " " << left_right;
      EXPECT_LE(d.rmse, searches_exactly(settings) ? 0.012 : 0.02) << variant.name << " " << left_right;
    }
  }
}

TEST(Metamorphic, orthographic_is_the_limit_of_a_small_field_of_view) {
  const Rendering parallel = room(0, 1, 0, 48, 36), narrow = room(0.25, 1, 0, 48, 36);
  for (const auto& variant : estimators()) {
    const EstimatorSettings settings = converged(variant.settings, kRadius);
    const Difference d = difference(ao_of(narrow.frame, settings), ao_of(parallel.frame, settings));
    EXPECT_LE(d.rmse, 0.02) << variant.name << " " << place(d, narrow.frame);
    EXPECT_LE(d.mean, variant.settings.estimator == Estimator::gtao ? 1e-3 : 0.01) << variant.name;
    EXPECT_LE(std::abs(d.bias), 2e-3) << variant.name;
  }
}

// Only how exactly depth is known changes. By that a pixel of the exact search may find two neighbours to be one
// surface, or not.
TEST(Metamorphic, an_orthographic_eye_may_be_anywhere_on_its_ray) {
  const HostFrame frame = room(0, 1, 0, 48, 36).frame;
  for (const double farther : {10.0, 100.0, 1000.0}) {
    HostFrame moved = frame;
    for (float& z : moved.depth)
      if (z < kSky) z = float(z + farther);
    for (const auto& variant : estimators()) {
      const EstimatorSettings settings = with_radius(variant.settings, kRadius);
      const Difference d = difference(ao_of(moved, settings), ao_of(frame, settings));
      EXPECT_LE(d.rmse, searches_exactly(variant.settings) ? 6e-3 : 5e-3)
          << variant.name << " " << farther << " " << place(d, frame) << " " << d.max;
      EXPECT_LE(std::abs(d.bias), 5e-4) << variant.name << " " << farther;
    }
  }
}

// Of every thickness: a larger sphere holds more occluders, and more of what is behind their fronts. Where a surface
// leaves the sphere between two samples is interpolated, so a pixel may be off by a little. Not of Crytek, whose
// samples move as the radius grows. Nor of what goes on beyond the border: that must rise by a part of the radius and
// begin within a multiple of it, so a larger one may leave it out. The worst that was measured of bitmask with endless
// occluders is 3.4e-4, from the sector that the tangent plane cuts; of finite ones 0.0102, since of several runs before
// the sphere only the thickest counts. For a larger radius the exact search takes parallel faces farther apart for one:
// 0.0361.
TEST(Metamorphic, a_larger_radius_only_darkens) {
  const HostFrame frame = room(55, 1, 0, 48, 36).frame;
  auto all = solid_estimators();
  std::ranges::copy(estimators(), std::back_inserter(all));
  for (const auto& variant : all) {
    if (variant.settings.estimator == Estimator::crytek) continue;
    std::vector<float> smaller(frame.data.pixels(), 1.0f);
    const float slack = searches_exactly(variant.settings)                       ? 0.038f
                        : variant.settings.thickness == ThicknessKind::automatic ? 0.012f
                        : variant.settings.thickness == ThicknessKind::constant  ? 0.006f
                        : variant.settings.estimator == Estimator::bitmask       ? 5e-4f
                                                                                 : 1e-6f;
    for (const double radius : {1e-9, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 1e9}) {
      EstimatorSettings settings = converged(variant.settings, radius);
      settings.thickness_length = 0.2;
      settings.complete = Completion::none;
      const std::vector<float> ao = ao_of(frame, settings);
      for (std::size_t i = 0; i < ao.size(); i++)
        EXPECT_LE(ao[i], smaller[i] + slack) << variant.name << " radius " << radius << " pixel " << i;
      if (radius < 1e-6) EXPECT_GE(std::ranges::min(ao), 1 - 1e-6f) << variant.name << " below a pixel";
      EXPECT_LE(difference(ao, smaller).bias, 1e-6) << variant.name << " radius " << radius;
      smaller = ao;
    }
  }
}

// Whatever the radius; with each change every second radius of each estimator. Behind what is nearer only of a given
// thickness: where surfaces go on there, the automatic one is half as thick. The worst that was measured is 3.8e-4 of
// samples, from the sector that the tangent plane cuts, and 0.0099 of the exact search, where the sphere cuts the
// straight line from the far end of what is seen of a surface to the far end of what goes on of it, and not both of
// these.
TEST(Metamorphic, completing_only_darkens) {
  const HostFrame frame = room(55, 1, 0, 48, 36).frame;
  auto all = solid_estimators();
  for (Variant variant : estimators()) {
    all.push_back(variant);
    variant.settings.thickness = ThicknessKind::constant;
    if (searches_exactly(variant.settings)) all.push_back(variant);
  }
  int number = 0;
  for (const auto& variant : all) {
    int turn = number++;
    const bool is_endless = variant.settings.thickness == ThicknessKind::infinite;
    const float slack_of_samples = is_endless ? 1e-6f : 5e-4f;
    const float slack = searches_exactly(variant.settings) ? 0.012f : slack_of_samples;
    int darker = 0;
    for (const double radius : {1e-9, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 1e9}) {
      if (!tried(turn++, 2)) continue;
      EstimatorSettings settings = converged(variant.settings, radius);
      settings.thickness_length = 0.2;
      settings.complete = Completion::none;
      const std::vector<float> seen = ao_of(frame, settings);
      std::vector<float> before = seen;
      for (const Completion completion : {Completion::border, Completion::all}) {
        settings.complete = completion;
        if (completion == Completion::all && settings.thickness == ThicknessKind::automatic) continue;
        const std::vector<float> ao = ao_of(frame, settings);
        for (std::size_t i = 0; i < ao.size(); i++) {
          EXPECT_LE(ao[i], before[i] + slack)
              << variant.name << " completion " << int(completion) << " radius " << radius << " pixel " << i;
        }
        before = ao;
      }
      for (std::size_t i = 0; i < before.size(); i++) darker += before[i] < seen[i] - 0.05f;
    }
    EXPECT_EQ(darker > 0, completes_anywhere(variant.settings)) << variant.name;
  }
}

// With an endless radius: within one, what comes before a blocker may be out of reach itself. Of solid occluders: a
// thin one hides more than it blocks. Bits are counted with a random shift, the same in both frames.
TEST(Metamorphic, an_added_occluder_never_brightens_what_is_still_seen) {
  const Plane floor{.point = {}, .normal = {0, 0, 1}}, wall{.point = {}, .normal = {1, 0, 0}};
  const Sphere ball{.center = {1.5, 0.2, 0.8}, .radius = 0.3};
  const Shot shot = Shot::perspective({4, -1, 3}, {0.8, 0, 0.4}, 55, 64, 48);
  const Rendering without = render({{floor, wall}}, shot), with = render({{floor, wall, ball}}, shot);
  for (const auto& variant : solid_estimators()) {
    EstimatorSettings settings = converged(variant.settings, 100);
    if (variant.settings.estimator == Estimator::crytek) settings.radius = 1;
    const std::vector<float> before = ao_of(without.frame, settings), after = ao_of(with.frame, settings);
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

/// Whether a surface is at the picture's border.
bool is_cut_by_border(const HostFrame& frame) {
  const int width = frame.data.width, height = frame.data.height;
  for (int i = 0; i < width * height; i++) {
    const int x = i % width, y = i / width;
    const bool at_border = x == 0 || y == 0 || x == width - 1 || y == height - 1;
    if (at_border && frame.depth[std::size_t(i)] < kSky) return true;
  }
  return false;
}

// What the picture shows whole is not completed: its faces are connected, and behind them is sky. Where the border cuts
// it, the planes of the border's pixels go on, and may rise above what is rounded. The worst that was measured of
// samples is .0197, of a ball no larger than the radius.
TEST(Metamorphic, a_convex_body_alone_is_open) {
  const Sphere ball{.center = {6, 0.4, -0.3}, .radius = 1.5};
  const Plane plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})};
  const Vec3 a = 1.6 * unit({1, 0.5, 0.3}), b = 1.2 * unit(cross(a, {0, 0, 1})), c = 1.4 * unit(cross(a, b));
  Scene box;
  box.add(parallelepiped({5, -0.5, 0.3}, a, b, c));
  int whole = 0;
  for (const Scene& scene : {Scene{{ball}}, Scene{{plane}}, box})
    for (const double fov : {0.0, 0.5, 20.0, 90.0, 150.0, 170.0}) {
      const HostFrame frame = render(scene, along_x(fov, 48, 36, 5)).frame;
      const bool is_cut = is_cut_by_border(frame);
      whole += !is_cut;
      for (const auto& variant : estimators())
        for (const double radius : {1e-6, 0.05, 1.0, 1e6}) {
          // The strokes of an exact search keep to the surface within a fifth of a pixel, which is most at the rim of a
          // ball and at a box's edges.
          const bool exact = searches_exactly(variant.settings);
          const bool has_edges = scene.primitives.size() > 1;
          EstimatorSettings settings = with_radius(variant.settings, radius);
          settings.complete = Completion::none;
          const std::vector<float> seen = ao_of(frame, settings);
          settings.complete = Completion::all;
          const std::vector<float> completed = ao_of(frame, settings);
          if (!is_cut) EXPECT_TRUE(same_bits(completed, seen)) << variant.name << " fov " << fov;
          for (const bool completes : {false, true}) {
            const double worst_edge = completes && is_cut ? 0.22 : 0.2;
            const Difference d = difference(completes ? completed : seen, [](std::size_t) { return 1.0; });
            const double rounded = completes && is_cut ? 0.025 : 0;
            EXPECT_LE(d.max, !exact      ? std::max(rounded, 1e-4)
                             : has_edges ? worst_edge
                                         : std::max(rounded, 0.01))
                << variant.name << " fov " << fov << " radius " << radius << " " << place(d, frame);
            EXPECT_LE(d.rmse, exact                 ? 0.01
                              : completes && is_cut ? 1e-3
                                                    : 1e-5)
                << variant.name << " fov " << fov << " radius " << radius;
          }
        }
    }
  EXPECT_GE(whole, 6);
}

// To 89.99 degrees. From 85 on a pixel's own footprint is longer than the radius, and rounded normals (4e-5 rad) tilt
// the plane by part of what is left. With each change each estimator and radius meets every second turn.
TEST(Metamorphic, a_plane_at_a_grazing_angle_is_open) {
  int number = 0;
  for (const auto& [what, rendering] :
       slanted_planes({60, 85, 89, 89.9, 89.99}, {0, 37, 90, 200}, {0, 0.01, 60}, 48, 36, 60, 0.01)) {
    int turn = number++;
    for (const auto& variant : estimators())
      for (const double radius : {0.05, 1.0, 1e6}) {
        if (!tried(turn++, 2)) continue;
        const EstimatorSettings settings = with_radius(variant.settings, radius);
        SCOPED_TRACE(what + ", " + variant.name);
        expect_open(rendering.frame, settings, searches_exactly(settings) ? 3e-3 : 1e-3);
      }
  }
}

}  // namespace
}  // namespace alcove::metamorphic_test
