// Lattices of sites, and frames to choose sites in: walls, and pictures of what the rule of sites must tell apart.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

/// A coordinate in a period, also left of the first one.
inline int within(int x, int period) { return (x % period + period) % period; }

/// Whether a pixel lies on the lattice of a spacing; it counts from the display window's corner.
inline bool is_on_lattice(int x, int y, int spacing) {
  const int u = within(x, 4), v = within(y, 4);
  switch (spacing) {
    case 16: return u == 0 && v == 0;
    case 8: return u % 2 == 0 && v == 0;
    case 4: return u % 2 == 0 && v % 2 == 0;
    case 2: return (u + v) % 2 == 0;
    default: return true;
  }
}

/// Pictures made of what the rule must tell apart: a tilted wall, blades a pixel wide, patches, and sky.
inline HostFrame random_picture(std::mt19937& random) {
  const auto whole = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto number = [&](double least, double most) { return std::uniform_real_distribution(least, most)(random); };
  const int width = whole(1, 75), height = whole(1, 45);
  const Vec3 normal = unit({-1, number(-1, 1), number(-1, 1)});
  Shot shot = whole(0, 3) > 0 ? Shot::perspective({}, {1, 0, 0}, 50, width, height)
                              : Shot::orthographic({}, {1, 0, 0}, 4, width, height);
  shot.data.x = whole(-9, 9);
  shot.data.y = whole(-9, 9);
  HostFrame frame = render({{Plane{.point = {5, 0, 0}, .normal = normal}}}, shot).frame;
  const auto put = [&](int x, int y, double depth) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const std::size_t i = std::size_t(y * width + x), pixels = frame.depth.size();
    frame.depth[i] = float(depth);
    frame.normal[i] = frame.normal[i + pixels] = 0;
    frame.normal[i + 2 * pixels] = 1;
  };
  for (int things = whole(0, 30); things > 0; things--) {
    const int x = whole(-4, width), y = whole(-4, height);
    const double depth = whole(0, 2) == 0 ? kSky : number(1, 4), slope = number(-1.5, 1.5);
    const int kind = whole(0, 2), reach = whole(1, 30);
    for (int i = 0; i < reach; i++) {
      if (kind == 0) put(x + i, y + int(std::floor(i * slope)), depth);
      if (kind == 1) put(x + int(std::floor(i * slope)), y + i, depth);
      for (int j = 0; kind == 2 && j < reach / 2 + 1; j++) put(x + i, y + j, depth);
    }
  }
  return frame;
}

/// Puts strands a pixel wide before what a frame shows.
inline void add_strands(HostFrame& frame) {
  const int width = frame.data.width, height = frame.data.height;
  std::mt19937 random(3);
  for (int strand = 0; strand < 14; strand++) {
    const double slope = double(random() % 400) / 100 - 2, x0 = random() % unsigned(width);
    const auto top = int(random() % unsigned(height)), bottom = std::min(height, top + 10 + int(random() % 40));
    for (int y = top; y < bottom; y++) {
      const int x = int(std::floor(x0 + slope * (y - top)));
      if (x >= 0 && x < width) frame.depth[std::size_t(y * width + x)] *= 0.93f;
    }
  }
}

/// A tilted wall that fills the picture, which lies so far from the display window's corner.
inline HostFrame wall_at(int x, int y, int width, int height, Vec3 normal, bool orthographic) {
  Shot shot = orthographic ? Shot::orthographic({}, {1, 0, 0}, 4, width, height)
                           : Shot::perspective({}, {1, 0, 0}, 40, width, height);
  shot.data.x = x;
  shot.data.y = y;
  shot.camera.cx += x;
  shot.camera.cy += y;
  return render({{Plane{.point = {5, 0, 0}, .normal = normal}}}, shot).frame;
}

/// Two planes at a right angle that opens towards the eye, along a slanting line; pixels beside it lie in both.
struct Crease {
  Rendering rendering = render({{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.8, 0.6})},
                                 Plane{.point = {5, 0, 0}, .normal = unit({-1, -0.8, -0.6})}}},
                               Shot::perspective({}, {1, 0, 0}, 60, 80, 60));

  /// 0 on the one plane, 1 on the other.
  std::vector<float> sides() const {
    std::vector<float> sides;
    for (const Hit& hit : rendering.hits) sides.push_back(float(hit.primitive));
    return sides;
  }
};

}  // namespace alcove::test
