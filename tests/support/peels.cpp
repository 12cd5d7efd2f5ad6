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

}  // namespace alcove::test
