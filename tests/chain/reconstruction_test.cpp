// Normals reconstructed from depth are nearer to the truth than cross products of neighbours, on curved surfaces and at
// edges.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"
#include "tests/support/scenes.h"

namespace alcove::reconstruction_test {
namespace {

using namespace test;

/// Of the angles to the true normals, degrees.
struct Angles {
  double mean = 0, above_10 = 0;  // above_10: share
};

template <class Normal>
Angles angles_of(const Rendering& rendering, const Normal& normal) {
  Angles angles;
  int count = 0;
  for (int y = 1; y + 1 < rendering.shot.data.height; y++)
    for (int x = 1; x + 1 < rendering.shot.data.width; x++) {
      if (rendering.at(x, y).primitive < 0) continue;
      const double cosine = dot(normal(x, y), rendering.shot.view_from_world(rendering.at(x, y).normal));
      const double angle = std::acos(std::min(1.0, std::abs(cosine))) / kRadian;
      angles.mean += angle, angles.above_10 += angle > 10, count++;
    }
  angles.mean /= count, angles.above_10 /= count;
  return angles;
}

Angles reconstructed(const Rendering& rendering) {
  HostFrame frame = rendering.frame;
  frame.normal.clear();
  const std::vector<Vec3> normals = vectors_in(planes_of(frame, plain_settings(), "normal").normal);
  return angles_of(rendering, [&](int x, int y) { return normals[std::size_t(y * frame.data.width + x)]; });
}

/// The cross product of the differences to the right and lower neighbours.
Angles crossed(const Rendering& rendering) {
  const auto place = [&](int x, int y) {
    const auto& hit = rendering.at(x, y);
    const Ray ray = rendering.shot.ray(x + 0.5, y + 0.5);
    return hit.primitive < 0 ? ray.origin + 1e3 * ray.direction : hit.position;
  };
  return angles_of(rendering, [&](int x, int y) {
    return unit(rendering.shot.view_from_world(cross(place(x + 1, y) - place(x, y), place(x, y + 1) - place(x, y))));
  });
}

TEST(Reconstruction, follows_curved_surfaces) {
  Scene scene;
  for (int i = 0; i < 9; i++)
    scene.primitives.push_back(Sphere{.center = {double(i % 3), double(i / 3), 0}, .radius = 0.48});
  const Rendering balls = render(scene, Shot::perspective({1, 1, 5}, {1, 1.001, 0}, 40, 240, 240));
  const Angles ours = reconstructed(balls), naive = crossed(balls);
  EXPECT_LT(ours.mean, 0.7) << "the other way: " << naive.mean;
  EXPECT_LT(ours.mean, 0.25 * naive.mean);
  EXPECT_LT(ours.above_10, 0.5 * naive.above_10);
}

TEST(Reconstruction, keeps_edges_of_flat_surfaces) {
  Scene scene{{kFloor}};
  for (int i = 0; i < 12; i++)
    scene.primitives.push_back(parallelogram({-3 + 0.5 * i, 0, 0}, {0.2, 0.1, 0}, {0, 0.3, 1}));
  for (const bool perspective : {true, false}) {
    const Rendering slats = render(scene, perspective ? Shot::perspective({0.5, -4, 3}, {0, 0, 0.3}, 60, 240, 160)
                                                      : Shot::orthographic({0.5, -4, 3}, {0, 0, 0.3}, 6, 240, 160));
    const Angles ours = reconstructed(slats), naive = crossed(slats);
    EXPECT_LT(ours.above_10, 0.01) << perspective;
    EXPECT_LT(ours.above_10, 0.15 * naive.above_10) << "the other way: " << naive.above_10;
    EXPECT_LT(ours.mean, 0.3) << perspective;
  }
}

}  // namespace
}  // namespace alcove::reconstruction_test
