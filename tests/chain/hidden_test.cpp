// The sampled estimators with surfaces behind the first: what these must change, and what they must not.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/scenes.h"

namespace alcove::hidden_test {
namespace {

using namespace test;

constexpr Estimator kLayered[] = {Estimator::gtao, Estimator::bitmask};

/// AO, bent normals, the shape of the own surface, and how many tiles were searched, with hidden surfaces and without.
struct Outcome {
  std::vector<float> values;
  TileCounts tiles;
};
Outcome outcome_of(const HostFrame& frame, const EstimatorSettings& settings) {
  Planes planes = planes_of(frame, settings, "ao,bent-normal,transfer,convexity,cavity");
  for (const auto* more : {&planes.bent, &planes.transfer, &planes.convexity, &planes.cavity})
    planes.ao.insert(planes.ao.end(), more->begin(), more->end());
  return {planes.ao, planes.tiles};
}
std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return outcome_of(frame, settings).values;
}

EstimatorSettings settings_of(Estimator estimator, double radius) {
  EstimatorSettings settings = sampled(estimator, radius, 3, 12);
  settings.thickness = ThicknessKind::automatic;
  return settings;
}

HostFrame with_plane(HostFrame frame, const std::vector<float>& depth, BehindKind kind = BehindKind::surfaces) {
  frame.behind.push_back({.kind = kind});
  frame.behind_depth.insert(frame.behind_depth.end(), depth.begin(), depth.end());
  return frame;
}

TEST(Hidden, a_copy_of_the_first_depth_and_a_surface_beyond_the_radius_change_no_bit) {
  const double radius = 0.3;
  const HostFrame room = furnished_room(61, 47).frame;
  float deepest = 0;
  for (const float z : room.depth) deepest = z < kSky ? std::max(deepest, z) : deepest;
  const std::vector<float> far(room.depth.size(), deepest + 4 * float(radius));
  HostFrame layered = room;
  // Of surfaces of unknown kind a far one could be the back of the first.
  for (int i = 0; i < 3; i++)
    layered = i == 1 ? with_plane(layered, far, BehindKind::fronts) : with_plane(layered, room.depth);
  for (const Estimator estimator : kLayered)
    for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::constant, ThicknessKind::infinite})
      for (const auto falloff : {Falloff::none, Falloff::smooth}) {
        if (!tried(int(estimator) + int(thickness) + int(falloff != Falloff::none), 2)) continue;
        EstimatorSettings settings = settings_of(estimator, radius);
        settings.thickness = thickness;
        settings.thickness_length = radius / 4;
        settings.falloff = falloff;
        EXPECT_TRUE(same_bits(run(room, settings), run(layered, settings))) << name_of(settings);
      }
}

/// A ball before a ball, over a floor and before a wall, with so many of the surfaces that they hide.
struct Balls {
  explicit Balls(int peels = 0) {
    if (peels > 0) add_solid_peels(rendering, scene, peels, {2, 3}, kNowhere, BehindKind::surfaces);
  }
  Scene scene{{parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}), Plane{{0, 1.2, 0}, {0, -1, 0}},
               Sphere{.center = {-0.1, -0.5, 0.35}, .radius = 0.3}, Sphere{.center = {0.1, 0.4, 0.4}, .radius = 0.35}}};
  Rendering rendering = render(scene, Shot::perspective({0.1, -3.2, 1.1}, {0, 0.2, 0.3}, 38, 121, 91));
};

/// RMS error against ray tracing, at receivers whose sphere is seen whole.
double error_of(const Rendering& rendering, const Scene& scene, const EstimatorSettings& settings) {
  const std::vector<float> ao = ao_of(rendering.frame, settings);
  const double radius = *settings.radius;
  double sum = 0;
  std::size_t count = 0;
  for (const std::size_t pixel : receivers(rendering, radius, 4, [](const Hit&) { return true; })) {
    const double error = ao[pixel] - true_ao(scene, rendering.hits[pixel], radius, 32);
    sum += error * error;
    count++;
  }
  EXPECT_GT(count, 40u);
  return std::sqrt(sum / double(count));
}

EstimatorSettings dense(Estimator estimator, double radius) {
  EstimatorSettings settings = settings_of(estimator, radius);
  settings.slices = 16;
  settings.steps = 64;
  return settings;
}

TEST(Hidden, balls_block_from_their_fronts_to_their_backs) {
  const Balls balls, peeled(3);
  for (const Estimator estimator : kLayered) {
    const EstimatorSettings settings = dense(estimator, 0.6);
    const double before = error_of(balls.rendering, balls.scene, settings);
    const double after = error_of(peeled.rendering, peeled.scene, settings);
    EXPECT_LT(after, 0.02) << "estimator " << int(estimator) << ", without peels " << before;
    EXPECT_LT(after, 0.6 * before) << "estimator " << int(estimator);
  }
}

TEST(Hidden, a_plate_hides_a_post_that_blocks_the_floor_behind_it) {
  const Scene scene{{parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}),
                     parallelogram({-0.5, -0.3, 0.15}, {1, 0, 0}, {0, 0, 0.5}),
                     parallelogram({-0.25, 0.3, 0.05}, {0.5, 0, 0}, {0, 0, 0.4})}};
  const Rendering plain = render(scene, Shot::perspective({0, -3, 1.4}, {0, 0, 0.1}, 36, 241, 181));
  Rendering peeled = plain;
  add_solid_peels(peeled, scene, 3, {}, kNowhere, BehindKind::surfaces);
  EstimatorSettings settings = dense(Estimator::gtao, 0.5);
  settings.thickness = ThicknessKind::constant;
  settings.thickness_length = 0.01;
  settings.complete = Completion::none;
  const double before = error_of(plain, scene, settings), after = error_of(peeled, scene, settings);
  EXPECT_LT(after, 0.008) << "without peels " << before;
  EXPECT_LT(after, 0.4 * before);
}

TEST(Hidden, what_is_left_out_has_the_bits_of_what_is_computed) {
  RandomScenes scenes(20);
  for (int i = 0; i < (long_tests() ? 24 : 12); i++) {
    HostFrame frame = scenes.next();
    const std::vector<float> first = frame.depth;
    const double radius = scenes.radius();
    for (int k = 1; k <= 3; k++) {
      std::vector<float> behind = first;
      const float apart = float(radius) * 0.01f * float(scenes.whole(1, 120));
      for (std::size_t p = 0; p < behind.size(); p++)
        behind[p] = behind[p] < kSky && (p / 7 + std::size_t(k)) % 3 != 0 ? behind[p] + float(k) * apart : kSky;
      frame = with_plane(frame, behind, scenes.whole(0, 2) == 0 ? BehindKind::backs : BehindKind::surfaces);
    }
    EstimatorSettings settings = settings_of(kLayered[scenes.whole(0, 1)], radius);
    settings.thickness = scenes.thickness();
    settings.thickness_length = radius / 4;
    settings.steps = 24;
    std::vector<float> skipped = run(frame, settings);
    settings.no_skip = true;
    EXPECT_TRUE(same_bits(skipped, run(frame, settings))) << "scene " << i;
  }
}

/// With something hidden in some columns of the image.
HostFrame with_hidden_part(HostFrame frame, int first_x, int last_x, float behind, BehindKind kind) {
  std::vector<float> depth(frame.depth.size(), kSky);
  const int width = frame.data.width;
  for (std::size_t p = 0; p < depth.size(); p++) {
    const int x = int(p) % width;
    if (x >= first_x && x <= last_x && frame.depth[p] < kSky) depth[p] = frame.depth[p] + behind;
  }
  return with_plane(std::move(frame), depth, kind);
}

// Where nothing is hidden within reach another kernel searches. A bit that differs shows that something was.
TEST(Hidden, tiles_far_from_what_is_hidden_have_the_bits_of_a_search_for_it) {
  RandomScenes scenes(21);
  uint layered = 0, listed = 0;
  for (int i = 0; i < (long_tests() ? 24 : cases_of(18)); i++) {
    HostFrame frame = scenes.next();
    const double radius = scenes.radius();
    const int first = scenes.whole(0, frame.data.width - 1);
    // A back that lies far away says how thick a near front is.
    const bool has_backs = i % 2 == 1;
    const float behind = float(radius) * 0.01f * float(scenes.whole(1, has_backs ? 1000 : 150));
    frame = with_hidden_part(frame, first, first + scenes.whole(0, 12), behind,
                             has_backs ? BehindKind::backs : BehindKind::fronts);
    EstimatorSettings settings = settings_of(kLayered[i % 6 / 3], radius);
    settings.falloff = i % 4 != 3 ? Falloff::none : Falloff::smooth;
    settings.stride = i % 2 == 0 ? 4 : 1;
    const Outcome skipped = outcome_of(frame, settings);
    layered += skipped.tiles.layered;
    listed += skipped.tiles.listed;
    settings.no_skip = true;
    EXPECT_TRUE(same_bits(skipped.values, run(frame, settings))) << "scene " << i;
  }
  EXPECT_GT(layered, 0u);
  EXPECT_LT(layered, listed);
}

TEST(Hidden, a_tenth_of_the_picture_leaves_the_rest_to_the_plain_search) {
  const HostFrame room = furnished_room(321, 121).frame;
  const HostFrame part = with_hidden_part(room, 0, 32, 0.05f, BehindKind::fronts);
  const TileCounts tiles = outcome_of(part, settings_of(Estimator::gtao, 0.1)).tiles;
  EXPECT_GT(tiles.layered, 0u);
  EXPECT_LT(tiles.layered, tiles.listed / 3) << "of " << tiles.listed;
  EXPECT_EQ(outcome_of(room, settings_of(Estimator::gtao, 0.1)).tiles.layered, 0u);
}

TEST(Hidden, smaller_images_keep_what_their_pixels_hide) {
  const Balls balls, peeled(3);
  EstimatorSettings settings = dense(Estimator::gtao, 0.6);
  settings.resolution = Resolution::half;
  EXPECT_LT(error_of(peeled.rendering, peeled.scene, settings),
            0.75 * error_of(balls.rendering, balls.scene, settings));
}

}  // namespace
}  // namespace alcove::hidden_test
