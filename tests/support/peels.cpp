// Rays that go on behind what they hit.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/peels.h"

namespace alcove::test {

HostFrame peeled(const Scene& scene, const Shot& shot, int surfaces) {
  constexpr double kBehind = 1e-9;  // of the depth: where the next surface may begin
  HostFrame frame = render(scene, shot).frame;
  frame.behind.assign(std::size_t(surfaces - 1), {});
  for (int k = 1; k < surfaces; k++)
    for (int y = 0; y < shot.data.height; y++)
      for (int x = 0; x < shot.data.width; x++) {
        Ray ray = shot.ray(shot.data.x + x - shot.display.x + 0.5, shot.data.y + y - shot.display.y + 0.5);
        double depth = 0;
        for (int i = 0; i <= k && depth < kNowhere; i++) {
          const double step = scene.hit(ray).distance;
          depth += step;
          ray.origin = ray.origin + (step * (1 + kBehind)) * ray.direction;
        }
        frame.behind_depth.push_back(depth < kNowhere ? float(depth) : kSky);
      }
  return frame;
}

void add_solid_peels(Rendering& rendering, const Scene& scene, int count, const std::vector<int>& solids, double within,
                     BehindKind fronts) {
  const Shot& shot = rendering.shot;
  const std::size_t pixels = shot.data.pixels();
  HostFrame& frame = rendering.frame;
  for (int i = 0; i < count; i++) {
    frame.behind.push_back({fronts});
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
