// The truth of scenes whose surfaces hide each other: rays cast from receivers, and pixels that are good receivers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

#include "tests/support/scenes.h"

namespace alcove::test {

/// The mean over across x across rays of a receiver, as dense as the cosine to its normal, of what `value`
/// gives for what a ray hits and for its direction.
inline double mean_over_rays(const Scene& scene, const Hit& receiver, int across,
                             const std::function<double(const Hit&, const Vec3&)>& value) {
  const Vec3 x = unit(cross(std::abs(receiver.normal.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, receiver.normal));
  const Vec3 y = cross(receiver.normal, x);
  double sum = 0;
  for (int i = 0; i < across; i++) {
    const double out = std::sqrt((i + 0.5) / across);
    for (int j = 0; j < across; j++) {
      const double azimuth = 2 * std::numbers::pi * (j + 0.5) / across;
      const Vec3 direction =
          out * (std::cos(azimuth) * x + std::sin(azimuth) * y) + std::sqrt(1 - out * out) * receiver.normal;
      sum += value(scene.hit({receiver.position, direction}), direction);
    }
  }
  return sum / (double(across) * across);
}

inline double true_ao(const Scene& scene, const Hit& receiver, double radius, int across) {
  return mean_over_rays(scene, receiver, across,
                        [&](const Hit& hit, const Vec3&) { return hit.distance < radius ? 0.0 : 1.0; });
}

/// A wall x = 0 that ends behind a column, and what a receiver sees of the part of the wall's plane that the column
/// hides from the eye: of that without wall, and with it.
struct EndingWall {
  Vec3 eye{5, 0.2, 1.2};
  Polygon column = parallelogram({0.8, -0.15, 0.02}, {0, 0.3, 0}, {0, 0, 5});
  Scene scene{{Plane{.point = {}, .normal = {0, 0, 1}}, parallelogram({0, -4, 0}, {0, 4, 0}, {0, 0, 4}), column}};

  struct Share {
    double open = 0, wall = 0;
  };
  Share hidden_from(const Hit& receiver, double radius, int across) const {
    Share share;
    const Scene columns{{column}};
    share.open = mean_over_rays(scene, receiver, across, [&](const Hit& hit, const Vec3& direction) {
      const double to_plane = -receiver.position.x / direction.x;
      if (!(to_plane > 0 && to_plane < radius)) return 0.0;
      const Vec3 on_plane = receiver.position + to_plane * direction;
      if (columns.hit({eye, on_plane - eye}).distance >= 1) return 0.0;
      share.wall += hit.primitive == 1 ? 1.0 / (double(across) * across) : 0;
      return hit.distance >= radius ? 1.0 : 0.0;
    });
    return share;
  }
};

using Chosen = std::function<bool(const Hit&)>;

/// Pixels of a grid, `every` pixels apart, that show a chosen surface, are not beside an edge, and whose sphere of the
/// radius is in the picture.
inline std::vector<std::size_t> receivers(const Rendering& rendering, double radius, int every, const Chosen& chosen) {
  std::vector<std::size_t> pixels;
  for (int y = 2; y < rendering.shot.data.height; y += every) {
    for (int x = 2; x < rendering.shot.data.width; x += every) {
      const Hit& hit = rendering.at(x, y);
      if (hit.primitive >= 0 && rendering.primitives_within(2, x, y) == 1 &&
          rendering.shot.sees_ball(hit.position, radius) && chosen(hit))
        pixels.push_back(std::size_t(y) * std::size_t(rendering.shot.data.width) + std::size_t(x));
    }
  }
  return pixels;
}

}  // namespace alcove::test
