// Places of a picture: pixels, the rays through them, and the points that depth gives them; samples of a frame that is
// read window by window.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>

#include "core/base/image.h"
#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// The step, in pixels, that is fine enough for the statistics of a frame. It is a prime: no column is favoured.
constexpr std::size_t kSparse = 31;

/// Pixels that are enough for shares to a percent.
constexpr std::size_t kNormalPixels = 1 << 13;

/// Gives a step between pixels by which about `count` of them are taken, or a few more, and no column is favoured.
inline std::size_t even_step(const Window& window, std::size_t count) {
  std::size_t step = window.pixels() / count + 1;
  while (std::gcd(step, std::size_t(window.width)) > 1) step++;
  return step;
}

/// The step between places: about 112 of them lie along the longer side, enough for shares to a percent.
inline int sparseness(const View& view) {
  constexpr int kAcross = 112;
  return std::max(1, std::max(view.size.x, view.size.y) / kAcross);
}

inline std::size_t index_of(const View& view, int x, int y) {
  return std::size_t(y) * std::size_t(view.size.x) + std::size_t(x);
}

/// Gives the point where the pixel's ray meets the plane at unit depth; orthographic: the pixel's place in the plane.
inline Vector3 tangent_at(const View& view, int x, int y) {
  return {(x + 0.5 - view.center.x) * view.tangent_per_pixel.x, (y + 0.5 - view.center.y) * view.tangent_per_pixel.y,
          -1};
}

/// The value of a pixel: one, or a position's three.
inline Vector3 value_at(std::span<const float> raw, std::size_t plane, std::size_t i) {
  return raw.size() == 3 * plane ? Vector3{raw[i], raw[i + plane], raw[i + 2 * plane]} : Vector3{raw[i], 0, 0};
}

/// The planar depth of a pixel; infinite where it shows no surface.
inline double planar_depth_at(const DepthMap& map, std::span<const float> raw, const View& view, int x, int y) {
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  return planar_depth(map, value_at(raw, plane, index_of(view, x, y)), map.along_ray ? ray_length(view, x, y) : 1);
}

/// A pixel of the sample.
struct SampledPixel {
  std::size_t number;  // in the sample of the whole
  std::size_t at;      // in the planes of the window
  Vector3 values;      // of the depth as the file has it: one, or three of a position
  double ray;          // length of the pixel's ray of unit depth; 1 where it is orthographic
};

/// Gives the step, in pixels, of a sample of about `count` pixels of the whole.
inline std::size_t sampling_step(const Window& whole, std::size_t count) { return whole.pixels() / count + 1; }

/// Calls `visit` with the pixels of `window` that belong to a sample of about `count` pixels of `whole`. A pixel has
/// the same number in every window, so the sample does not depend on how the whole is cut. `depth` and `view` are the
/// window's.
template <class Visit>
void for_each_sampled(const View& view, std::span<const float> depth, const Window& window, const Window& whole,
                      std::size_t count, const Visit& visit) {
  const std::size_t step = sampling_step(whole, count);
  for (std::size_t i = step / 2; i < whole.pixels(); i += step) {
    const int column = whole.x + int(i % std::size_t(whole.width)) - window.x,
              row = whole.y + int(i / std::size_t(whole.width)) - window.y;
    if (column < 0 || column >= window.width || row < 0 || row >= window.height) continue;
    const std::size_t at = index_of(view, column, row);
    visit(SampledPixel{i / step, at, value_at(depth, window.pixels(), at), ray_length(view, column, row)});
  }
}

}  // namespace alcove
