// Half and quarter resolution: nothing shifts, surfaces keep to themselves. What holds of every setting stands in
// property_test.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"

namespace alcove::resolution_test {
namespace {

using namespace test;

class Reduced : public testing::TestWithParam<Resolution> {
 protected:
  int factor() const { return int(GetParam()); }
  std::vector<float> upsampled(const HostFrame& frame, const std::function<double(int, int)>& ao_of_block) const {
    EstimatorSettings settings = sampled(Estimator::gtao, 1, 1, 1);
    settings.resolution = GetParam();
    return test::upsampled(frame, ao_of_block, settings);
  }
};
INSTANTIATE_TEST_SUITE_P(, Reduced, testing::Values(Resolution::half, Resolution::quarter),
                         [](const auto& value) { return value.param == Resolution::half ? "half" : "quarter"; });

// A visibility that changes evenly over the image comes back as it was: half a pixel's shift would be 0.5 x 0.004 off.
TEST_P(Reduced, ramp_comes_back_where_it_was) {
  const double by_x = 0.004, by_y = -0.003;
  for (const auto& [what, rendering] : slanted_planes({0, 49}, {52}, {50}, 97, 71)) {
    const auto ramp = [&](double x, double y) { return 0.4 + by_x * x + by_y * y; };
    const auto at_center = [&](int x, int y) { return ramp((x + 0.5) * factor(), (y + 0.5) * factor()); };
    const auto ao = upsampled(rendering.frame, at_center);
    int compared = 0;
    for (int y = factor(); y < 71 - 2 * factor(); y++) {
      for (int x = factor(); x < 97 - 2 * factor(); x++, compared++)
        ASSERT_NEAR(ao[std::size_t(y * 97 + x)], ramp(x + 0.5, y + 0.5), 2e-4) << x << " " << y;
    }
    EXPECT_GT(compared, 3000);
  }
}

/// How far one result would have to be moved to fit another best, by least squares, over what is away from the edges of
/// surfaces.
std::pair<double, double> shift_of(const std::vector<float>& moved, const std::vector<float>& still,
                                   const Rendering& rendering,
                                   const std::function<std::pair<int, int>(int, int)>& source) {
  const int width = rendering.shot.data.width, height = rendering.shot.data.height;
  double xx = 0, xy = 0, yy = 0, x_error = 0, y_error = 0;
  for (int y = 8; y < height - 8; y++) {
    for (int x = 8; x < width - 8; x++) {
      const auto [source_x, source_y] = source(x, y);
      if (rendering.primitives_within(6, source_x, source_y) > 1) continue;
      const auto at = [&](int u, int v) { return double(still[std::size_t(v * width + u)]); };
      const double dx = (at(x + 2, y) - at(x - 2, y)) / 4, dy = (at(x, y + 2) - at(x, y - 2)) / 4;
      const double error = at(x, y) - moved[std::size_t(y * width + x)];
      xx += dx * dx, xy += dx * dy, yy += dy * dy, x_error += dx * error, y_error += dy * error;
    }
  }
  const double determinant = xx * yy - xy * xy;
  return {(yy * x_error - xy * y_error) / determinant, (xx * y_error - xy * x_error) / determinant};
}

// The same through the whole chain, beside a wall. That few pixels see less of the wall looks like a shift away from
// it; in the mirrored frame that is a shift to the other side, which a real one is not.
// What goes on beyond the border begins at once as its slice turns, so with 16 slices it is noise that looks like a
// shift of 0.36 px at a quarter. It falls as slices are added, which a shift does not: to 0.069 px of 48, and to 0.035
// px of 128. So what completes surfaces has 48. With each change each completion is seen from one eye.
TEST(Resolution, of_the_shading_of_a_wall_shifts_nothing) {
  for (const auto& [completion, slices] : {std::pair{Completion::none, 16}, {Completion::all, 48}})
    for (const auto& [number, eye] : {std::pair{0, Vec3{4, -1, 3}}, {1, Vec3{3, 3, 3}}}) {
      if (!tried(number + (completion == Completion::all), 2)) continue;
      const Rendering rendering = render({{kFloor, kWallX}}, Shot::perspective(eye, {0.7, 0, 0.3}, 45, 160, 120));
      EstimatorSettings settings = sampled(Estimator::gtao, 1, slices, 64);
      settings.complete = completion;
      double shift[2][2]{};  // of a half and a quarter in x and y, which that of the mirrored frame takes part in
      for (const int flip : {0, 1, 2}) {
        const HostFrame frame = flip ? mirrored(rendering.frame, flip == 1) : rendering.frame;
        const auto source = [&](int x, int y) { return std::pair{flip == 1 ? 159 - x : x, flip == 2 ? 119 - y : y}; };
        settings.resolution = Resolution::full;
        const std::vector<float> whole = ao_of(frame, settings);
        for (const int i : {0, 1}) {
          settings.resolution = i ? Resolution::quarter : Resolution::half;
          const auto [x, y] = shift_of(ao_of(frame, settings), whole, rendering, source);
          if (flip != 2) shift[i][0] += x / 2;
          if (flip != 1) shift[i][1] += y / 2;
        }
      }
      for (const auto& [x, y] : shift) {
        EXPECT_LE(std::abs(x), 0.1) << "px in x, completion " << int(completion);
        EXPECT_LE(std::abs(y), 0.1) << "px in y, completion " << int(completion);
      }
    }
}

// Beyond a step, pixels take the blocks of their own depth as soon as one of the four about them has it.
TEST_P(Reduced, surfaces_beside_a_step_keep_to_themselves) {
  for (int edge = 36; edge < 40; edge++) {
    HostFrame frame = slanted_planes({0}, {0}, {60}, 80, 60)[0].rendering.frame;
    for (int i = 0; i < 80 * 60; i++)
      if (i % 80 >= edge) frame.depth[std::size_t(i)] = 8;
    const int near_blocks = (edge + factor() - 1) / factor();
    const auto ao = upsampled(frame, [&](int x, int) { return x < near_blocks ? 0 : 1; });
    for (int i = 0; i < 80 * 60; i++) {
      // the last near block's centre: from here on one of the four is far
      const double first_far_tap = (near_blocks - 0.5) * factor();
      if (i % 80 < edge) ASSERT_EQ(ao[std::size_t(i)], 0.0f) << "edge " << edge << " x " << i % 80;
      if (i % 80 >= edge && i % 80 > first_far_tap)
        ASSERT_EQ(ao[std::size_t(i)], 1.0f) << "edge " << edge << " x " << i % 80;
    }
  }
}

TEST_P(Reduced, sky_is_open_and_lightens_nothing) {
  const Rendering room = furnished_room(97, 71);
  const auto ao = upsampled(room.frame, [](int, int) { return 0.0; });
  for (std::size_t i = 0; i < ao.size(); i++) ASSERT_EQ(ao[i], room.hits[i].primitive < 0 ? 1.0f : 0.0f) << i;
}

TEST_P(Reduced, mirrored_blocks_give_the_mirrored_result) {
  const HostFrame frame = furnished_room(96, 72).frame;
  const auto value = [](int x, int y) { return (x * 7 + y * 13) % 32 / 31.0; };
  const int columns = 96 / factor(), rows = 72 / factor();
  const std::vector<float> upright = upsampled(frame, value);
  for (const bool left_right : {true, false}) {
    const auto mirrored_value = [&](int x, int y) {
      return left_right ? value(columns - 1 - x, y) : value(x, rows - 1 - y);
    };
    const Difference d =
        difference(upsampled(mirrored(frame, left_right), mirrored_value), mirrored(upright, frame, left_right));
    EXPECT_LE(d.max, 2e-3) << place(d, frame);
    EXPECT_LE(d.mean, 1e-5);
  }
}

}  // namespace
}  // namespace alcove::resolution_test
