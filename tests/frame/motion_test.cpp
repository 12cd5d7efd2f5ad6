// Motion vectors are read as the cameras prove them, and tell what moves.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/motion.h"
#include "tests/support/test.h"

namespace alcove::motion_test {
namespace {

constexpr int kWidth = 48, kHeight = 32;
constexpr Window kWindow{0, 0, kWidth, kHeight};

Camera camera_at(double x, double y, double z) {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 40;
  camera.cx = kWidth / 2.;
  camera.cy = kHeight / 2.;
  camera.view_from_world = Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  camera.view_from_world_offset = {-x, -y, -z};
  return camera;
}

/// A slope seen by a camera that was, is and will be at different places, and the way to both in pixels, y down.
class Motion : public testing::Test {
 protected:
  Motion() {
    for (int y = 0; y < kHeight; y++)
      for (int x = 0; x < kWidth; x++) depth.push_back(4 + 0.05f * float(x) + 0.02f * float(y));
    frame = {depth, view_of(now, kWindow, kWindow), from(before), from(after)};
    for (std::size_t i = 0; i < depth.size(); i++) {
      to_before.push_back(way(before, i));
      to_after.push_back(way(after, i));
    }
  }
  FromThere from(const Camera& there) const { return {view_from_view(there, now), view_of(there, kWindow, kWindow)}; }
  /// By similar triangles: all cameras look the same way.
  std::array<double, 2> way(const Camera& there, std::size_t i) const {
    const double x = double(i % kWidth) + 0.5 - kWidth / 2., y = double(i / kWidth) + 0.5 - kHeight / 2.;
    const double z = double(depth[i]), dx = there.view_from_world_offset[0] - now.view_from_world_offset[0],
                 dy = there.view_from_world_offset[1] - now.view_from_world_offset[1],
                 dz = there.view_from_world_offset[2] - now.view_from_world_offset[2];
    return {(x * z / 40 + dx) / (z - dz) * 40 - x, (y * z / 40 - dy) / (z - dz) * 40 - y};
  }
  static MotionPlanes::Pair pair(const std::vector<std::array<double, 2>>& ways, double by_x, double by_y) {
    MotionPlanes::Pair result;
    for (const auto& w : ways) {
      result.x.push_back(float(w[0] * by_x));
      result.y.push_back(float(w[1] * by_y));
    }
    return result;
  }

  const Camera before = camera_at(-0.2, 0.05, 0.1), now = camera_at(0, 0, 0), after = camera_at(0.25, -0.1, -0.3);
  std::vector<float> depth;
  MotionFrame frame;
  std::vector<std::array<double, 2>> to_before, to_after;
};

TEST_F(Motion, is_read_as_the_cameras_prove_it) {
  for (const MotionKind kind : {MotionKind::previous, MotionKind::next})
    for (const double sign : {1., -1.})
      for (const double up : {1., -1.})
        for (const auto& unit : {std::array{1., 1.}, {double(kWidth), double(kHeight)}, {kWidth / 2., kHeight / 2.}}) {
          const auto& ways = kind == MotionKind::previous ? to_before : to_after;
          const MotionPlanes planes{"v.exr", {pair(ways, sign / unit[0], sign * up / unit[1])}};
          const auto reading = best_motion_reading(planes, frame, MotionKind::automatic);
          ASSERT_TRUE(reading) << sign << " " << up << " " << unit[0];
          EXPECT_EQ(reading->kind, kind);
          EXPECT_EQ(reading->scale, (std::array{sign * unit[0], sign * up * unit[1]}));
          EXPECT_EQ(reading->share, 1);
          const auto moving = moving_by(planes, *reading, frame);
          EXPECT_EQ(std::ranges::count(moving, 0), kWidth * kHeight);
          const MotionKind other = kind == MotionKind::previous ? MotionKind::next : MotionKind::previous;
          EXPECT_FALSE(best_motion_reading(planes, frame, other)) << "they lead to the frame on the other side";
        }
}

TEST_F(Motion, takes_the_pair_whose_frame_is_there) {
  const MotionPlanes planes{"v.exr", {pair(to_before, 1, -1), pair(to_after, -1, 1)}};
  frame.previous.reset();
  const auto reading = best_motion_reading(planes, frame, MotionKind::automatic);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->pair, 1);
  EXPECT_EQ(reading->kind, MotionKind::next);
  frame.next.reset();
  EXPECT_FALSE(best_motion_reading(planes, frame, MotionKind::automatic));
}

TEST_F(Motion, of_an_object_covers_it_and_a_pixel_around_it) {
  MotionPlanes planes{"v.exr", {pair(to_before, 1, 1)}};
  for (int y = 10; y < 20; y++)
    for (int x = 10; x < 30; x++) planes.pairs[0].x[std::size_t(y * kWidth + x)] += 0.2f;
  planes.pairs[0].y[5] = NAN;
  depth[40] = kSkyDepth;
  planes.pairs[0].y[40] = 3;
  const auto reading = best_motion_reading(planes, frame, MotionKind::automatic);
  ASSERT_TRUE(reading);
  const auto moving = moving_by(planes, *reading, frame);
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) {
      const bool of_object = y >= 9 && y < 21 && x >= 9 && x < 31, of_nan = y < 2 && x >= 4 && x <= 6;
      EXPECT_EQ(moving[std::size_t(y * kWidth + x)], of_object || of_nan) << x << " " << y;
    }
}

TEST_F(Motion, that_nothing_shares_with_the_cameras_has_no_reading) {
  auto ways = to_before;
  for (std::size_t i = 0; i < ways.size(); i++) ways[i] = {double(i % 17) - 8, double(i % 23) - 11};
  EXPECT_FALSE(best_motion_reading({"v.exr", {pair(ways, 1, 1)}}, frame, MotionKind::automatic));
}

}  // namespace
}  // namespace alcove::motion_test
