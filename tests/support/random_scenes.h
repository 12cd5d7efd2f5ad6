// Scenes by chance, for what must hold in any.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

constexpr Estimator kEstimators[] = {Estimator::gtao, Estimator::bitmask, Estimator::hbao, Estimator::crytek};

/// A scene of a few flat and round things, seen from anywhere, also from within a corner.
class RandomScenes {
 public:
  explicit RandomScenes(unsigned seed) : random_(seed) {}

  /// times: as many pixels in x and y.
  HostFrame next(int times = 1) {
    Scene scene;
    scene.primitives.push_back(Plane{{0, 0, 0}, {0, 0, 1}});
    if (number(0, 1) < 0.5)
      scene.primitives.push_back(Plane{{0, number(1, 5), 0}, unit({number(-1, 1), -1, number(-0.3, 0.3)})});
    if (number(0, 1) < 0.3) scene.primitives.push_back(Plane{{number(-3, -1), 0, 0}, {1, 0, 0}});
    const int things = int(number(0, 6));
    for (int i = 0; i < things; i++) {
      const Vec3 at{number(-3, 3), number(-2, 4), number(0, 1)};
      if (number(0, 1) < 0.5)
        scene.primitives.push_back(Sphere{.center = at, .radius = number(0.02, 0.5)});
      else
        scene.primitives.push_back(parallelogram(at, vector(0.6), vector(0.6)));
    }
    const Vec3 eye{number(-0.8, 0.8), number(-4, 0.5), std::exp(number(-4, 1.5))},
        target{number(-1, 1), number(0, 3), number(-0.5, 0.5)};
    const int width = times * int(number(8, 97)), height = times * int(number(8, 65));
    Shot shot = number(0, 1) < 0.8 ? Shot::perspective(eye, target, number(5, 150), width, height)
                                   : Shot::orthographic(eye, target, number(0.5, 8), width, height);
    if (number(0, 1) < 0.3) shot.camera.cx += number(-1, 1) * width, shot.camera.fy *= number(0.4, 2.5);
    HostFrame frame = render(scene, shot).frame;
    const double kind = number(0, 1);
    if (kind < 0.15) {
      frame.depth_is_half = true;
      for (float& z : frame.depth) z = std::ldexp(std::round(std::ldexp(z, 10 - std::ilogb(z))), std::ilogb(z) - 10);
    } else if (kind < 0.3) {
      for (float& n : frame.normal) n = std::round(n * 2048) / 2048;
    } else if (kind < 0.4) {
      frame.normal.clear();
    }
    return frame;
  }
  double radius() { return std::exp(number(-5, 1.5)); }
  int whole(int least, int most) { return std::uniform_int_distribution(least, most)(random_); }
  Estimator estimator() { return kEstimators[int(number(0, 4)) & 3]; }
  ThicknessKind thickness() { return ThicknessKind(int(number(0, 3)) % 3); }

 private:
  double number(double least, double most) { return std::uniform_real_distribution(least, most)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

  std::mt19937 random_;
};

}  // namespace alcove::test
