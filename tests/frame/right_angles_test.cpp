// The shift of disparity is told by planes at right angles, and by no others.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/disparity.h"

#include <cmath>

#include "core/frame/samples.h"
#include "tests/support/test.h"

namespace alcove::right_angles_test {
namespace {

constexpr int kWidth = 240, kHeight = 160;

/// Planes by the directions of their normals, each in its strip of the picture, with the shift 0.3.
std::optional<RightAngles> found(const std::vector<Vector3>& planes) {
  View view{};
  view.size = {kWidth, kHeight};
  view.center = {0.5f * kWidth, 0.5f * kHeight};
  view.tangent_per_pixel = {1 / 200.0f, -1 / 200.0f};
  std::vector<float> raw;
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++) {
      const auto& plane = planes[std::size_t(x) * planes.size() / kWidth];
      const double side = std::abs(dot(plane, tangent_at(view, x, y)));
      raw.push_back(float(0.3 + 0.3 * side / length(plane)));
    }
  return shift_by_right_angles(view, raw, {});
}

/// The same turned about two axes, so that no plane is seen along itself.
std::vector<Vector3> turned(std::vector<Vector3> planes) {
  for (auto& [x, y, z] : planes) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    std::tie(x, z) = std::pair(c * x + s * z, c * z - s * x);
    std::tie(y, z) = std::pair(c * y + s * z, c * z - s * y);
  }
  return planes;
}

const std::vector<Vector3> kCorner{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(RightAngles, of_a_corner_tell_the_shift) {
  const auto of_corner = found(turned(kCorner));
  ASSERT_TRUE(of_corner);
  EXPECT_NEAR(of_corner->shift, 0.3, of_corner->error);
  EXPECT_LT(of_corner->error, 0.01);
}

TEST(RightAngles, are_not_taken_from_planes_without_a_corner) {
  EXPECT_FALSE(found(turned({{1, 0, 0}, {0, 1, 0}}))) << "two planes are perpendicular with more than one shift";
  EXPECT_FALSE(found(turned({{0, 1, 0}, {1, 0, 0}, {0.5, 0, 0.87}, {-0.5, 0, 0.87}}))) << "a column of six sides";
  EXPECT_FALSE(found(turned({{1, 0, 0}}))) << "one plane";
}

}  // namespace
}  // namespace alcove::right_angles_test
