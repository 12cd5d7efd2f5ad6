// The mean over frames on shots by chance: spheres and boxes that move, before a camera that moves, too.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/source_frame.h"
#include "tests/support/test.h"
#include "tests/support/walked_shot.h"

namespace alcove::moving_shots_test {
namespace {

using namespace test;

constexpr int kFrames = 9, kMiddle = 5;
constexpr int kWidth = 128, kHeight = 72;

/// A sphere or a box, where it is in the middle frame, and how far it moves from frame to frame.
struct Thing {
  bool is_sphere = false;
  Vec3 center;
  Vec3 edges[3];  // half of a box's; the first one is as long as a sphere's radius
  Vec3 velocity;
  int first = 1, last = kFrames;  // the frames between which it moves
};

/// A floor, a wall, things, and a camera's way past them.
struct MovingShot {
  std::vector<Thing> things;
  Vec3 eye, target, eye_velocity, target_velocity;
  double radius = 0;

  /// The scene of one frame.
  Scene scene(int frame) const {
    Scene scene;
    scene.primitives.push_back(test::Plane{{0, 0, 0}, {0, 0, 1}});
    scene.primitives.push_back(test::Plane{{0, 4, 0}, {0, -1, 0}});
    for (const auto& thing : things) {
      const double moved = std::clamp(frame, thing.first, thing.last) - std::clamp(kMiddle, thing.first, thing.last);
      const Vec3 center = thing.center + moved * thing.velocity;
      const auto& e = thing.edges;
      if (thing.is_sphere)
        scene.primitives.push_back(Sphere{.center = center, .radius = length(e[0])});
      else
        scene.add(parallelepiped(center - e[0] - e[1] - e[2], 2 * e[0], 2 * e[1], 2 * e[2]));
    }
    return scene;
  }
  Shot shot(int frame) const {
    const double t = frame - kMiddle;
    return Shot::perspective(eye + t * eye_velocity, target + t * target_velocity, 60, kWidth, kHeight);
  }
};

class ByChance {
 public:
  explicit ByChance(unsigned seed) : random_(seed) {}

  MovingShot shot() {
    MovingShot shot;
    const int still = int(number(1, 5)), moving = int(number(1, 3.999));
    for (int i = 0; i < still + moving; i++) shot.things.push_back(thing(i >= still));
    shot.eye = {number(-1.5, 1.5), number(-4, -2), number(0.6, 2.5)};
    shot.target = {number(-1, 1), 2, number(0, 1)};
    if (number(0, 1) < 0.8) shot.eye_velocity = vector(0.06);
    if (number(0, 1) < 0.5) shot.target_velocity = vector(0.06);
    shot.radius = number(0.2, 0.8);
    return shot;
  }

 private:
  Thing thing(bool moves) {
    Thing thing;
    thing.is_sphere = number(0, 1) < 0.5;
    thing.center = {number(-2, 2), number(0, 3.5), number(0, 1.2)};
    const double turn = number(0, 2 * std::numbers::pi), c = std::cos(turn), s = std::sin(turn);
    thing.edges[0] = number(0.1, 0.5) * Vec3{c, s, 0};
    thing.edges[1] = number(0.1, 0.5) * Vec3{-s, c, 0};
    thing.edges[2] = number(0.1, 0.5) * Vec3{0, 0, 1};
    if (!moves) return thing;
    thing.velocity = std::exp(number(-4, 0)) * unit(vector(1));
    // Some rest before they move, or come to rest.
    if (number(0, 1) < 0.3) thing.first = int(number(1, kFrames));
    if (number(0, 1) < 0.3) thing.last = int(number(thing.first + 1, kFrames + 1));
    return thing;
  }
  double number(double least, double most) { return std::uniform_real_distribution(least, most)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

  std::mt19937 random_;
};

/// The middle frame of a shot.
struct Middle {
  std::vector<float> alone, mean;  // AO of one frame, and the mean over frames
  std::vector<float> still;        // the mean where nothing but the camera moves
  Scene scene;
  Rendering seen;
  double radius = 0;
};

class MovingShots : public SequenceFolder {
 protected:
  void write(const MovingShot& shot, bool is_moving) const {
    json cameras = camera_of(shot.shot(1));
    cameras["normal_space"] = "world";
    for (int frame = 1; frame <= kFrames; frame++) {
      const Rendering rendering = render(shot.scene(is_moving ? frame : kMiddle), shot.shot(frame));
      cameras["frames"].push_back(
          {{"frame", frame}, {"world_to_camera", camera_of(rendering.shot)["world_to_camera"]}});
      file_of(rendering, kSky, planar, [](const Hit& hit) { return hit.normal; }).write(input(frame));
    }
    write_bytes(camera, cameras.dump());
  }

  /// The AO of the middle frame, without noise.
  std::vector<float> ao(const MovingShot& shot, const Options& more) const {
    remove_outputs();
    const Options plain = typed("--set stride=1 --denoise none --slices 16 --steps 32 --type float");
    done(
        joined(joined(plain, more), {"--frames", std::to_string(kMiddle), "--radius", fmt::format("{}", shot.radius)}));
    return read_exr_image(output(kMiddle), {"Y"}).pixels;
  }

  Middle middle_of(const MovingShot& shot) const {
    write(shot, false);
    const auto still = ao(shot, {"--accumulate", "4"});
    write(shot, true);
    const Scene scene = shot.scene(kMiddle);
    return {ao(shot, {}), ao(shot, {"--accumulate", "4"}),   still,
            scene,        render(scene, shot.shot(kMiddle)), shot.radius};
  }
};

/// How much farther off the truth the mean is at a pixel than one frame and than where all stands still.
double ghost(const Middle& middle, std::size_t pixel) {
  constexpr double kLeast = 0.02;
  const double alone = middle.alone[pixel], still = middle.still[pixel], mean = middle.mean[pixel];
  if (std::max(mean - std::max(alone, still), std::min(alone, still) - mean) < kLeast) return 0;
  const double truth = true_ao(middle.scene, middle.seen.hits[pixel], middle.radius, 16);
  return std::max(0.0, std::abs(mean - truth) - std::max(std::abs(alone - truth), std::abs(still - truth)));
}

/// Whether the mean ends in one step between two pixels of a surface that is smooth there.
bool is_seam(const Middle& middle, std::size_t a, std::size_t b) {
  constexpr double kSmooth = 0.01, kSeen = 0.02, kNothing = 1e-3;
  const auto is_smooth = [&](const std::vector<float>& ao) { return std::abs(double(ao[a]) - ao[b]) <= kSmooth; };
  const auto gain = [&](std::size_t i) { return std::abs(double(middle.mean[i]) - middle.alone[i]); };
  return middle.seen.hits[a].primitive == middle.seen.hits[b].primitive && is_smooth(middle.alone) &&
         is_smooth(middle.still) && std::min(gain(a), gain(b)) < kNothing && std::max(gain(a), gain(b)) > kSeen;
}

TEST_F(MovingShots, means_have_neither_ghosts_nor_seams) {
  const int shots = long_tests() ? 24 : cases_of(6);
  double square = 0;
  int seams = 0;
  for (int number = 0; number < shots; number++) {
    const Middle middle = middle_of(ByChance(unsigned(number)).shot());
    for (int y = 0; y + 1 < kHeight; y++)
      for (int x = 0; x + 1 < kWidth; x++) {
        const auto pixel = std::size_t(y * kWidth + x);
        const double error = ghost(middle, pixel);
        square += error * error / (double(kWidth) * kHeight * shots);
        for (const std::size_t next : {pixel + 1, pixel + kWidth}) seams += is_seam(middle, pixel, next);
      }
  }
  EXPECT_LT(std::sqrt(square), 0.0025);
  EXPECT_LE(seams, 2 * shots);
}

}  // namespace
}  // namespace alcove::moving_shots_test
