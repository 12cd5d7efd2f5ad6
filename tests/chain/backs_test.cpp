// How far back solids go in a search by samples, by all that is seen of them: against rays.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "kernels/estimate/estimate.h"
#include "tests/support/chain.h"
#include "tests/support/site_frames.h"

namespace alcove::backs_test {
namespace {

using namespace test;

Means means_of(const Scene& scene, const Shot& shot, const Chosen& chosen, int every) {
  EstimatorSettings settings = sampled(Estimator::gtao, 1, 8, 16);
  settings.thickness = ThicknessKind::automatic;
  settings.complete = Completion::all;
  return test::means_of(scene, shot, chosen, every, [&](const HostFrame& frame, const std::vector<std::size_t>&) {
    return ao_of(frame, settings);
  });
}

/// A ball and a box above a floor, before the sky.
Rendering ball_and_box(int width, int height, bool orthographic) {
  Scene scene{{kFloor, Sphere{.center = {0, 1.1, 0.8}, .radius = 0.6}}};
  scene.add(parallelepiped({-2, -1.5, 0.3}, {2, 0, 0}, {0, 1.6, 0}, {0, 0, 0.4}));
  const Vec3 eye{5, 0.3, 1.6}, target{0, 0, 0.4};
  return render(scene, orthographic ? Shot::orthographic(eye, target, 5, width, height)
                                    : Shot::perspective(eye, target, 50, width, height));
}

// With each change half of the combinations: each box from each eye and by each camera.
TEST(Backs, of_a_box_above_the_floor_are_no_farther_than_its_top_goes) {
  const Vec3 target{0, 0, 0.3};
  for (const Vec3 eye : {Vec3{6, 0, 2.2}, Vec3{5, 0, 4}})
    for (const Shot& shot :
         {Shot::perspective(eye, target, 42, 320, 224), Shot::orthographic(eye, target, 5, 320, 224)}) {
      int turn = (eye.z > 3) + shot.camera.orthographic;
      // One that is higher than deep is taken for as deep as it is high.
      for (const auto& [depth, height] : {std::pair(0.3, 0.2), {1.0, 0.2}, {1.0, 0.5}}) {
        if (!tried(turn++, 2)) continue;
        const Means below = means_of(box_above_floor(depth, 0.35, height), shot, is_below_box, 4);
        EXPECT_NEAR(below.ao, below.truth, 0.05) << depth << " deep, " << height << " high, from " << eye.z;
      }
    }
}

// Its top is a few rows of pixels.
TEST(Backs, of_a_box_are_as_far_as_its_top_goes_that_samples_miss) {
  for (const double eye : {0.9, 1.2}) {
    const Means below = means_of(box_above_floor(2, 0.35, 0.2),
                                 Shot::perspective({6, 0, eye}, {0, 0, 0.3}, 36, 400, 200), is_below_box, 4);
    EXPECT_NEAR(below.ao, below.truth, 0.07) << "seen from " << eye;
  }
}

/// The sides of an upright bar whose outer face is at x = 0.7; what is seen from below shows neither of its ends.
std::vector<Polygon> sides_of_bar(double width, double y) {
  const Vec3 corner{0.7 - width, y, 0}, x{width, 0, 0}, across{0, width, 0}, up{0, 0, 1.4};
  return {parallelogram(corner, across, up), parallelogram(corner + x, across, up), parallelogram(corner, x, up),
          parallelogram(corner + across, x, up)};
}

TEST(Backs, of_a_railing_are_no_farther_than_it_is_wide) {
  for (const double bar : {0.03, 0.06}) {
    // A floor that juts out of a wall, seen from below, with bars along its edge.
    Scene scene{{kWallX}};
    scene.add(parallelepiped({0, -3, -0.1}, {0.7, 0, 0}, {0, 6, 0}, {0, 0, 0.1}));
    for (int i = -12; i <= 12; i++) scene.add(sides_of_bar(bar, 0.2 * i));
    const auto is_behind = [](const Hit& hit) {
      return hit.primitive == 0 && std::abs(hit.position.y) < 1 && std::abs(hit.position.z - 0.7) < 0.3;
    };
    const Means wall = means_of(scene, Shot::perspective({6, -1.5, -2}, {0, 0, 0.4}, 26, 480, 336), is_behind, 9);
    EXPECT_NEAR(wall.ao, wall.truth, 0.05) << bar;
  }
}

TEST(Backs, of_a_ball_mirror_its_front) {
  const Scene scene{{kFloor, Sphere{.center = {0, 0, 0.8}, .radius = 0.5}}};
  for (const double eye : {3.0, 1.0}) {
    const Means beside = means_of(
        scene, Shot::perspective({5, 0, eye}, {0, 0, 0.3}, 40, 320, 224),
        [](const Hit& hit) { return hit.primitive == 0 && std::hypot(hit.position.x, hit.position.y) < 1; }, 4);
    EXPECT_LE(beside.error, 0.05) << eye;
  }
}

/// What the passes make of a frame, and what a walk from pixel to pixel makes of the same links.
class Walked {
 public:
  Walked(const HostFrame& frame, double radius, bool has_normals) : radius_(radius) {
    gpu::Recorder& gpu = recorder();
    const GBuffer gbuffer = prepared(frame).gbuffer;
    const auto& [words, chains] =
        backs(gpu, gbuffer, reach_of(sampled(Estimator::gtao, radius, 2, 16), radius), has_normals);
    geometry_.emplace(gbuffer);
    links_ = downloaded<std::uint32_t>(chains);
    words_ = downloaded<std::uint32_t>(words);
  }

  ivec2 size() const { return view().size; }
  bool shows_surface(ivec2 p) const { return z_of(p) < kSky; }
  double apart(ivec2 a, ivec2 b) const { return std::abs(z_of(a) - z_of(b)) / width_of(z_of(a) < z_of(b) ? a : b); }

  /// Whether a pixel goes on from the one before it in its row, or its column.
  bool goes_on(ivec2 p, bool is_column) const { return bit(p, is_column, 0); }

  /// Of the word of a pixel, in pixels' widths.
  double depth_in_word(ivec2 p) const { return unpacked(words_[index_of(p)] & 255, 4); }
  double mirrored_in_word(ivec2 p, int side) const {
    const std::uint32_t word = words_[index_of(p)] >> (8 + 6 * side) & 63;
    return word == 0 ? -1 : unpacked(word, 2);
  }

  double depth_by_walk(ivec2 p) const {
    const Told sides[] = {walk(p, {-1, 0}), walk(p, {1, 0}), walk(p, {0, -1}), walk(p, {0, 1})};
    const double row = std::max({sides[0].depth, sides[1].depth, 0.0});
    const double column = std::max({sides[2].depth, sides[3].depth, 0.0});
    const double row_size = 1.5 * (sides[0].size + sides[1].size + width_of(p));
    const double column_size = 1.5 * (sides[2].size + sides[3].size + width_of(p));
    return in_widths(p, std::max(std::min(row, column_size), std::min(column, row_size)));
  }
  double mirrored_by_walk(ivec2 p, int side) const {
    const ivec2 ways[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    const Told there = walk(p, ways[side]);
    const int chain = there.steps + walk(p, {-ways[side].x, -ways[side].y}).steps;
    return there.is_round && chain >= 3 ? std::max(in_widths(p, std::max(there.farther, 0.0) * 2), 1.0) : -1;
  }

 private:
  const View& view() const { return geometry_->view; }
  struct Told {
    int steps = 0;
    double depth = 0, farther = 0, size = 0;
    bool is_round = false;
  };

  static double unpacked(std::uint32_t word, int mantissa) {
    return std::ldexp(1 + double(word & ((1U << mantissa) - 1)) / (1 << mantissa), int(word >> mantissa) - 2);
  }

  std::size_t index_of(ivec2 p) const { return geometry_->index(p.x, p.y); }
  double z_of(ivec2 p) const { return geometry_->depth[index_of(p)]; }
  double width_of(ivec2 p) const { return view().tangent_per_pixel.x * (view().orthographic != 0 ? 1 : z_of(p)); }
  Vec3 position_of(ivec2 p) const { return geometry_->point(p.x, p.y); }
  double eye_distance(ivec2 p) const { return view().orthographic != 0 ? z_of(p) : length(position_of(p)); }
  double in_widths(ivec2 p, double along_ray) const {
    return std::min(along_ray, kMostBack * radius_) * z_of(p) / eye_distance(p) / width_of(p);
  }
  bool bit(ivec2 p, bool is_column, std::size_t of_two) const {
    const int segments = (view().size.x + kSegment - 1) / kSegment, below = (view().size.y + kSegment - 1) / kSegment;
    const int first = is_column ? view().size.y * segments + p.x * below : p.y * segments;
    const int step = is_column ? p.y : p.x;
    return (links_[2 * std::size_t(first + step / kSegment) + of_two] >> (step % kSegment) & 1) != 0;
  }

  Told walk(ivec2 p, ivec2 way) const {
    const bool is_column = way.y != 0, is_before = way.x + way.y < 0;
    const double pixel = std::abs(is_column ? view().tangent_per_pixel.y : view().tangent_per_pixel.x);
    const int most = int(kLongestChain * radius_ / (view().orthographic != 0 ? 1 : z_of(p)) / pixel);
    Told told;
    ivec2 end = p;
    while (told.steps < most) {
      const ivec2 next{end.x + way.x, end.y + way.y};
      const bool exists = next.x >= 0 && next.y >= 0 && next.x < view().size.x && next.y < view().size.y;
      if (!exists || !goes_on(is_before ? end : next, is_column)) break;
      end = next;
      told.steps++;
    }
    const Vec3 along = position_of(end) - position_of(p);
    told.farther = eye_distance(end) - eye_distance(p);
    told.depth = std::min(told.farther, -dot(geometry_->normal_of(p.x, p.y), along));
    told.size = length(along);
    told.is_round = told.steps < most && bit(end, is_column, 1);
    return told;
  }

  double radius_;
  std::optional<Geometry> geometry_;
  std::vector<std::uint32_t> links_, words_;
};

// Pictures whose lines fill their last segment or do not, and radii that end chains or do not.
TEST(Backs, of_each_pixel_are_those_of_a_walk_along_its_links) {
  int deep = 0, round = 0;
  for (const auto& [width, height] : {std::pair(1, 1), {31, 3}, {32, 64}, {33, 32}, {65, 97}, {160, 129}})
    for (const double radius : {0.05, 0.4, 3.0})
      for (const bool orthographic : {false, true}) {
        SCOPED_TRACE(fmt::format("{} x {}, radius {}, orthographic {}", width, height, radius, orthographic));
        const Rendering room = ball_and_box(width, height, orthographic);
        const Walked walked(room.frame, radius, true);
        for (int y = 0; y < height; y++)
          for (int x = 0; x < width; x++) {
            if (!walked.shows_surface({x, y})) continue;
            const double depth = walked.depth_by_walk({x, y}), said = walked.depth_in_word({x, y});
            EXPECT_NEAR(said, std::max(depth, 0.25), 0.035 * said + 0.01) << x << " " << y;
            deep += depth > 3;
            for (int side = 0; side < 4; side++) {
              const double mirrored = walked.mirrored_by_walk({x, y}, side);
              const double told = walked.mirrored_in_word({x, y}, side);
              EXPECT_EQ(mirrored < 0, told < 0) << x << " " << y << " side " << side;
              if (told >= 0) EXPECT_NEAR(told, mirrored, 0.14 * told + 0.01) << x << " " << y << " side " << side;
              round += told >= 0;
            }
          }
      }
  EXPECT_GT(deep, 1000);
  EXPECT_GT(round, 1000);
}

TEST(Backs, without_normals_go_by_links_of_depth_alone) {
  const Rendering room = ball_and_box(65, 70, false);
  const Walked walked(room.frame, 1e-3, false);  // no faces that are linked are parallel ones before each other
  int linked = 0, parted = 0;
  for (int y = 1; y < walked.size().y; y++)
    for (int x = 1; x < walked.size().x; x++)
      for (const bool is_column : {false, true}) {
        const ivec2 here{x, y}, before = is_column ? ivec2{x, y - 1} : ivec2{x - 1, y};
        if (!walked.shows_surface(here) || !walked.shows_surface(before)) {
          EXPECT_FALSE(walked.goes_on(here, is_column)) << x << " " << y;
          continue;
        }
        const double apart = walked.apart(before, here);
        if (apart < 0.99) EXPECT_TRUE(walked.goes_on(here, is_column)) << x << " " << y;
        if (apart > 8.01) EXPECT_FALSE(walked.goes_on(here, is_column)) << x << " " << y;
        linked += apart < 0.99;
        parted += apart > 8.01;
      }
  EXPECT_GT(linked, 1000);
  EXPECT_GT(parted, 20);
}

}  // namespace
}  // namespace alcove::backs_test
