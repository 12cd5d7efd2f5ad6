// What lies behind the first surface of an analytic scene, as planes of depth: peels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "tests/support/scenes.h"

namespace alcove::test {

/// How much farther than a surface its ray goes on from there, as a part of the surface's depth.
constexpr double kBehindSurface = 1e-6;

/// Gives the rendering's frame two planes for each of so many surfaces behind the first: one of fronts, and one of
/// backs, which are seen where a ray leaves a solid of the scene. What lies farther behind the first surface than
/// `within` is left out.
inline void add_solid_peels(Rendering& rendering, const Scene& scene, int count, const std::vector<int>& solids = {},
                            double within = kNowhere) {
  const Shot& shot = rendering.shot;
  const std::size_t pixels = shot.data.pixels();
  HostFrame& frame = rendering.frame;
  for (int i = 0; i < count; i++) {
    frame.behind.push_back({BehindKind::fronts});
    frame.behind.push_back({BehindKind::backs});
  }
  frame.behind_depth.assign(2 * std::size_t(count) * pixels, kSky);
  const auto is_solid = [&](int primitive) { return std::ranges::find(solids, primitive) != solids.end(); };
  for (std::size_t i = 0; i < pixels; i++) {
    if (rendering.hits[i].primitive < 0) continue;
    const int x = int(i) % shot.data.width, y = int(i) / shot.data.width;
    const Ray ray = shot.ray(shot.data.x - shot.display.x + x + 0.5, shot.data.y - shot.display.y + y + 0.5);
    std::vector<int> entered;
    Hit hit = rendering.hits[i];
    double depth = hit.distance;
    for (int k = 0; k <= count && hit.primitive >= 0 && depth - rendering.hits[i].distance < within; k++) {
      const bool leaves = is_solid(hit.primitive) && std::erase(entered, hit.primitive) > 0;
      if (is_solid(hit.primitive) && !leaves) entered.push_back(hit.primitive);
      if (k > 0) frame.behind_depth[(2 * std::size_t(k - 1) + (leaves ? 1 : 0)) * pixels + i] = float(depth);
      const double onward = depth * (1 + kBehindSurface);
      hit = scene.hit({ray.origin + onward * ray.direction, ray.direction});
      depth = onward + hit.distance;
    }
  }
}

}  // namespace alcove::test
