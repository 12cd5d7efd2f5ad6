// The truth of scenes whose surfaces hide each other: rays cast from receivers, and pixels that are good receivers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/chain.h"

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
  Scene scene{{kFloor, parallelogram({0, -4, 0}, {0, 4, 0}, {0, 0, 4}), column}};

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

/// Surfaces that something hides a part of, and from which of them one sees it.
struct Hiding {
  const char* what;
  Scene scene;
  double radius;
  Chosen chosen;
  Shot perspective, orthographic;
};
const Scene kPlateScene{{kFloor, kWallX, parallelogram({0.8, -0.5, 0.45}, {0, 1, 0}, {0, 0, 0.8})}};
inline bool is_floor_by_the_wall(const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.7; }

inline std::vector<Hiding> hidings(int width, int height) {
  const Sphere half{.center = {0.9, 0, 0.8}, .radius = 0.2, .axis = unit({2.1, 0, 2.7}), .cos_half_angle = 0.15};
  return {{"a plate", kPlateScene, 1, is_floor_by_the_wall,
           Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, width, height),
           Shot::orthographic({5, 0.3, 1.8}, {0.3, 0, 0.6}, 5, width, height)},
          {"a column",
           {{kWallY, kWallX, parallelogram({0.75, 0.35, -9}, {-0.15, 0.15, 0}, {0, 0, 18})}},
           0.8,
           [](const Hit& hit) { return hit.primitive == 1 && hit.position.y < 0.6; },
           Shot::perspective({4, 4, 1}, {0.3, 0.3, 0}, 45, width, height),
           Shot::orthographic({4, 4, 1}, {0.3, 0.3, 0}, 4, width, height)},
          {"half a sphere",
           {{kFloor, kWallX, half}},
           0.8,
           [](const Hit& hit) { return hit.primitive == 1 && hit.position.z < 0.5; },
           Shot::perspective({3, 0, 3.5}, {0.3, 0, 0.3}, 50, width, height),
           Shot::orthographic({3, 0, 3.5}, {0.3, 0, 0.3}, 4, width, height)}};
}

/// A picture of a wall, and what is left of it when all of the wall but a height of 0.25 is cut off.
struct CutWall {
  explicit CutWall(const Shot& shot) : whole(render({{kFloor, kWallX}}, shot)) {
    while (whole.at(shot.data.width / 2, rows).position.z > 0.25) rows++;
    frame = crop_of(whole.frame, {0, rows, shot.data.width, shot.data.height - rows});
  }
  /// The pixel of the frame that shows what that pixel of the whole shows.
  std::size_t below(std::size_t pixel) const { return pixel - std::size_t(rows * frame.data.width); }

  Rendering whole;
  int rows = 0;
  HostFrame frame;
};

/// Things that have nothing but the sky about them, and so nothing that could go on.
inline std::vector<HostFrame> things_before_the_sky(int width, int height) {
  std::vector<HostFrame> frames;
  for (const Scene& scene : {Scene{{Sphere{.center = {0, 0, 0}, .radius = 1}}},
                             Scene{{parallelogram({-1, -1, -0.5}, {2, 0.3, 0}, {0, 2, 1})}},
                             Scene{{parallelogram({-1, 0, -1}, {0.05, 0, 0}, {0, 0, 2})}}})
    for (const Shot& shot : {Shot::perspective({3, -4, 2}, {0, 0, 0}, 60, width, height),
                             Shot::orthographic({3, -4, 2}, {0, 0, 0}, 6, width, height)})
      frames.push_back(render(scene, shot).frame);
  return frames;
}

}  // namespace alcove::test
