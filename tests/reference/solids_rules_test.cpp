// What is one surface, and how far back it is solid: each rule of the CPU reference by itself along one line, and
// scenes whose truth rays tell.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference.h"
#include "core/reference/reference_slice.h"
#include "tests/support/chain.h"

namespace alcove::solids_rules_test {
namespace {

using namespace test;

constexpr double kPixel = 0.02;
constexpr int kReceiver = 20;  // its row

/// A parallel view, 50 pixels wide per unit, whose rows each show one surface. A receiver sees them step by step down
/// the column.
class Rows {
 public:
  /// So many rows of a depth that grows by so many pixels' widths per row.
  Rows& add(int count, double depth, double slope = 0) {
    for (int i = 0; i < count; i++) add_row(depth + i * slope * kPixel, {0, -slope, 1});
    return *this;
  }
  Rows& add_row(double depth, Vec3 normal) {
    depths_.push_back(float(depth));
    normals_.push_back(unit(normal));
    return *this;
  }

  ReferenceLine line(double radius = 1, ThicknessRule thickness = ThicknessRule::width) const {
    const HostFrame frame = made();
    const ReferenceScene scene(frame);
    ReferenceSettings settings;
    settings.radius = radius;
    settings.thickness = thickness;
    settings.thickness_length = 0.1;
    settings.width_share = 0.5;
    settings.width_pixels = 1;
    settings.complete = Completion::all;
    const double depth = scene.depth(1, kReceiver);
    const ReferenceReceiver receiver{
        1, kReceiver, depth, scene.position(1, kReceiver, depth), {0, 0, 1}, scene.normal(1, kReceiver, {0, 0, 1})};
    const ReferenceSide side{{0, -1, 0}, {0, -1, 0}, {0, 0, 1}, 0, 0, 1, radius / kPixel};
    return line_of(scene, receiver, side, settings);
  }

 private:
  HostFrame made() const {
    HostFrame frame;
    const int rows = int(depths_.size());
    frame.data = frame.display = {0, 0, 3, rows};
    frame.camera.orthographic = true;
    frame.camera.width = 3;
    frame.camera.height = rows;
    frame.camera.fx = frame.camera.fy = 1 / kPixel;
    for (const float depth : depths_) frame.depth.insert(frame.depth.end(), 3, depth);
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
      for (const Vec3& normal : normals_) frame.normal.insert(frame.normal.end(), 3, float(normal.*axis));
    return frame;
  }

  std::vector<float> depths_;
  std::vector<Vec3> normals_;
};

/// A floor that the receiver lies on, up to the row at 10 steps.
Rows floor_before() { return Rows().add(kReceiver + 10, 5); }

/// Whether the sample of a step is one surface with that of the step before.
bool is_linked(const ReferenceLine& line, int step) { return line[step].nearer == step - 1; }

double levelled(double width, double most) {
  const double part = std::min(width / most, 1.0);
  return most * part * (1 - part * part / 3);
}

TEST(Surfaces, in_one_plane_are_one_however_steep_it_is) {
  Rows plane = floor_before(), steps = floor_before();
  plane.add(10, 3, 12);
  for (int i = 0; i < 10; i++) steps.add_row(3 + i * 12 * kPixel, {0, 0, 1});
  EXPECT_TRUE(is_linked(plane.line(), 14));
  EXPECT_FALSE(is_linked(steps.line(), 14));
  EXPECT_FALSE(is_linked(plane.line(1, ThicknessRule::constant), 14)) << "a rule of `auto` alone";
}

TEST(Surfaces, that_meet_at_an_edge_are_one) {
  const auto front_and_top = [](double gap) { return floor_before().add(10, 4.6).add(10, 4.6 + gap, 12).line(); };
  EXPECT_TRUE(is_linked(front_and_top(12 * kPixel), 20));
  EXPECT_FALSE(is_linked(front_and_top(14 * kPixel), 20)) << "the top lies behind the front";
}

TEST(Surfaces, of_the_receiver_are_sure) {
  const double slope = 6 * kPixel;
  EXPECT_FALSE(is_linked(floor_before().add(10, 5 - slope).line(), 10));
  EXPECT_TRUE(is_linked(floor_before().add(10, 5 - 3 * kPixel).line(), 10));
  EXPECT_TRUE(is_linked(floor_before().add(10, 4).add(10, 4 - slope).line(), 20)) << "of another run";
}

TEST(Surfaces, that_are_parallel_before_each_other_are_two) {
  const Rows rows = floor_before().add(10, 4).add(10, 4 - 7 * kPixel);
  EXPECT_FALSE(is_linked(rows.line(1), 20)) << "0.14 apart, and an eighth of the radius is 0.125";
  EXPECT_TRUE(is_linked(rows.line(1.2), 20));
}

TEST(Thickness, is_how_far_back_a_surface_is_seen_to_go) {
  const ReferenceLine line = floor_before().add(10, 4.2).add(10, 4.2 + 9 * kPixel, 9).add(10, 9).line();
  ASSERT_TRUE(is_linked(line, 20));
  EXPECT_NEAR(line[12].thickness, 1.8, 1e-5) << "the top goes 1.8 back";
  const double width = 0.5 * (std::hypot(1.8, 19 * kPixel) + kPixel) + kPixel;
  EXPECT_NEAR(line[25].thickness, levelled(width, 4), 1e-5) << "nothing lies behind the top";
}

TEST(Thickness, of_what_is_longer_than_its_width_counts_is_by_the_width_alone) {
  const ReferenceLine line = floor_before().add(10, 4.2).add(80, 4.2 + 9 * kPixel, 9).line();
  ASSERT_TRUE(is_linked(line, 20));
  EXPECT_NEAR(line[12].thickness, levelled(4, 4), 1e-5);
}

TEST(Thickness, of_a_rounded_outline_mirrors_its_front) {
  constexpr double kRadius = 10 * kPixel, kCenter = 4.5;
  Rows rows = floor_before();
  const auto height = [](int i) { return std::sqrt(kRadius * kRadius - std::pow((i - 9.5) * kPixel, 2)); };
  for (int i = 0; i < 20; i++) rows.add_row(kCenter - height(i), {0, (9.5 - i) * kPixel, height(i)});
  const ReferenceLine line = rows.add(10, 5).line();
  for (const int i : {3, 8, 12}) EXPECT_NEAR(line[10 + i].thickness, 2 * (height(i) - height(0)), 1e-5);
  EXPECT_NEAR(line[10].thickness, kPixel, 1e-5);
}

TEST(Thickness, goes_from_a_flat_end_straight_back) {
  const ReferenceLine line = floor_before().add(10, 4.6).add(20, 5).line();
  ASSERT_EQ(line.closing.size(), 1u);
  const auto& [from, to] = line.closing[0];
  EXPECT_NEAR(from.z, 0.4, 1e-5);
  EXPECT_NEAR(to.z, 0.4 - line[10].thickness, 1e-5);
  EXPECT_NEAR(to.y, from.y, 1e-5);
  EXPECT_TRUE(floor_before().add(30, 5.4).line().closing.empty()) << "it hides nothing";
}

/// Rows of one depth whose normals differ from one to the next.
Rows& add_rough(Rows& rows, int count, double depth) {
  for (int i = 0; i < count; i++) rows.add_row(depth, {0, i % 2 ? 0.1 : -0.1, 1});
  return rows;
}

TEST(Thickness, of_what_is_flat_levels_off_later) {
  const double width = 0.5 * 150 * kPixel + kPixel;
  EXPECT_NEAR(floor_before().add(150, 4).add(20, 5).line()[12].thickness, levelled(width, 4), 1e-5);
  Rows rough = floor_before();
  EXPECT_NEAR(add_rough(rough, 150, 4).add(20, 5).line()[12].thickness, levelled(width, 2), 1e-5);
}

TEST(Thickness, of_what_is_flat_and_cut_by_the_border_is_a_radius) {
  EXPECT_NEAR(floor_before().add(5, 4).line()[12].thickness, 1, 1e-5);
  Rows rough = floor_before();
  EXPECT_NEAR(add_rough(rough, 5, 4).line()[12].thickness, 0.5, 1e-5);
}

// Against rays.

/// Of the chosen pixels, for a radius of 1, by the reference and by rays.
Means means_of(const Scene& scene, const Shot& shot, const Chosen& chosen, int every = 3) {
  ReferenceSettings settings;
  settings.radius = 1;
  settings.slices = 32;
  settings.thickness = ThicknessRule::width;
  settings.width_share = 0.5;
  settings.width_pixels = 1;
  settings.complete = Completion::all;
  return test::means_of(scene, shot, chosen, every,
                        [&](const HostFrame& frame, const std::vector<std::size_t>& pixels) {
                          settings.pixels = pixels;
                          return reference_ao(frame, settings);
                        });
}

TEST(Solids, a_box_above_the_floor_shades_what_is_below_it) {
  const Vec3 eye{6, 0, 2.2}, target{0, 0, 0.3};
  for (const Shot& shot : {Shot::perspective(eye, target, 42, 160, 112), Shot::orthographic(eye, target, 5, 160, 112)})
    for (const double height : {0.2, 0.5}) {
      const Means below = means_of(box_above_floor(1, 0.35, height), shot, is_below_box, 4);
      EXPECT_NEAR(below.ao, below.truth, 0.03) << height;
      EXPECT_LE(below.error, 0.03) << height;
    }
}

// The edge of a table is taken to go down along the eye's rays: its floor is a tenth too dark.
TEST(Solids, a_slab_on_legs_is_no_darker_than_its_thickness_makes_it) {
  const Shot shot = Shot::perspective({6, 0, 2.2}, {0, 0, 0.3}, 42, 160, 112);
  const Means below = means_of(box_above_floor(2, 0.6, 0.06), shot, is_below_box, 4);
  EXPECT_NEAR(below.ao, below.truth, 0.11);
  const Means before = means_of(
      box_above_floor(2, 0.6, 0.06), shot,
      [](const Hit& hit) { return hit.primitive == 0 && hit.position.x > 0 && hit.position.x < 0.8; }, 6);
  EXPECT_NEAR(before.ao, before.truth, 0.03);
}

TEST(Solids, a_ball_above_a_floor_goes_back_as_it_comes_forward) {
  for (const double height : {0.5, 0.8})
    for (const double eye : {3.0, 1.0}) {
      const Scene scene{{kFloor, Sphere{.center = {0, 0, height}, .radius = 0.5}}};
      const Means beside =
          means_of(scene, Shot::perspective({5, 0, eye}, {0, 0, 0.3}, 40, 160, 112),
                   [](const Hit& hit) { return hit.primitive == 0 && std::hypot(hit.position.x, hit.position.y) < 1; });
      EXPECT_LE(beside.error, 0.055) << height << ", " << eye;
    }
}

// Of its bottom one sees walls at a grazing angle, which are planes.
TEST(Solids, a_hole_three_radii_deep_is_dark) {
  const Means walls = means_of(round_hole(0.5, 3, 16), Shot::perspective({2, 0, 6}, {0, 0, -0.5}, 26, 160, 160),
                               [](const Hit& hit) { return hit.primitive > 1 && hit.position.z < -0.3; });
  EXPECT_LE(walls.error, 0.19);
  const Means bottom = means_of(round_hole(0.5, 3, 16), Shot::perspective({0.6, 0, 6}, {0, 0, -0.5}, 26, 160, 160),
                                [](const Hit& hit) { return hit.primitive == 1; });
  EXPECT_LE(bottom.error, 0.23);
}

TEST(Solids, a_recess_has_the_jamb_that_is_hidden) {
  constexpr double kDepth = 0.5;
  const Scene recess{{parallelogram({0, 0.4, -5}, {0, 6, 0}, {0, 0, 10}),
                      parallelogram({0, -6, -5}, {0, 5.6, 0}, {0, 0, 10}),
                      parallelogram({-kDepth, -0.4, -5}, {0, 0.8, 0}, {0, 0, 10}),
                      parallelogram({-kDepth, 0.4, -5}, {kDepth, 0, 0}, {0, 0, 10}),
                      parallelogram({-kDepth, -0.4, -5}, {kDepth, 0, 0}, {0, 0, 10})}};
  for (const double y : {3.0, 1.5}) {
    const auto is_back = [](const Hit& hit) { return hit.primitive == 2 && std::abs(hit.position.z) < 1; };
    EXPECT_LE(means_of(recess, Shot::perspective({5, y, 0}, {0, 0, 0}, 40, 200, 100), is_back, 4).error, 0.012) << y;
  }
}

TEST(Solids, bars_of_a_railing_that_hide_each_other_are_many) {
  Scene scene{{kFloor}};
  for (int i = 0; i < 6; i++) scene.add(parallelepiped({0.3 * i, -1.5, 0.3}, {0.04, 0, 0}, {0, 3, 0}, {0, 0, 0.04}));
  const Means floor = means_of(
      scene, Shot::perspective({-6, 0, 0.6}, {0.8, 0, 0.3}, 20, 200, 100),
      [](const Hit& hit) {
        return hit.primitive == 0 && std::abs(hit.position.y) < 0.6 && std::abs(hit.position.x - 0.8) < 1.6;
      },
      4);
  EXPECT_NEAR(floor.ao, floor.truth, 0.05);
}

// It is too dark, as by any guess that it is a solid.
TEST(Solids, a_curved_sheet_is_taken_for_a_solid) {
  const Scene scene{{kFloor, Sphere{.center = {0, 0, 0.2}, .radius = 0.7, .axis = {0, 0, 1}, .cos_half_angle = 0.2}}};
  const Means beside = means_of(scene, Shot::perspective({5, 0, 2}, {0, 0, 0.3}, 40, 160, 112), [](const Hit& hit) {
    return hit.primitive == 0 && std::hypot(hit.position.x, hit.position.y) < 1.2;
  });
  EXPECT_LT(beside.ao, beside.truth);
  EXPECT_LE(beside.error, 0.08);
}

TEST(Solids, a_wall_seen_at_a_grazing_angle_shades_the_floor) {
  Scene scene{{kFloor}};
  scene.add(parallelepiped({-4, 0, 0.15}, {8, 0, 0}, {0, 1, 0}, {0, 0, 0.5}));
  const Means beside = means_of(
      scene, Shot::perspective({-9, -0.6, 1}, {0, 0, 0.3}, 30, 240, 96),
      [](const Hit& hit) {
        return hit.primitive == 0 && std::abs(hit.position.y + 0.3) < 0.5 && std::abs(hit.position.x) < 2;
      },
      2);
  EXPECT_LE(beside.error, 0.021) << "0.029 where steep planes are no surfaces";
}

}  // namespace
}  // namespace alcove::solids_rules_test
