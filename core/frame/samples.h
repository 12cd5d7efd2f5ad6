// Samples of a frame that is read window by window.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/image.h"
#include "core/frame/camera/camera.h"
#include "core/frame/reading.h"

namespace alcove {

/// The step, in pixels, that is fine enough for the statistics of a frame. It is a prime: no column is favoured.
constexpr std::size_t kSparse = 31;

/// A pixel of the sample.
struct SampledPixel {
  std::size_t number;            // in the sample of the whole
  std::size_t at;                // in the planes of the window
  std::array<double, 3> values;  // of the depth as the file has it: one, or three of a position
  double ray;                    // length of the pixel's ray of unit depth; 1 where it is orthographic
};

/// Gives the step, in pixels, of a sample of about `count` pixels of the whole.
inline std::size_t sampling_step(const Window& whole, std::size_t count) { return whole.pixels() / count + 1; }

/// Calls `visit` with the pixels of `window` that belong to a sample of about `count` pixels of `whole`. A pixel has
/// the same number in every window, so the sample does not depend on how the whole is cut. `depth` and `view` are the
/// window's.
template <class Visit>
void for_each_sampled(const View& view, std::span<const float> depth, const Window& window, const Window& whole,
                      std::size_t count, const Visit& visit) {
  const std::size_t pixels = window.pixels(), step = sampling_step(whole, count);
  for (std::size_t i = step / 2; i < whole.pixels(); i += step) {
    const int column = whole.x + int(i % std::size_t(whole.width)) - window.x,
              row = whole.y + int(i / std::size_t(whole.width)) - window.y;
    if (column < 0 || column >= window.width || row < 0 || row >= window.height) continue;
    SampledPixel pixel{i / step,
                       std::size_t(row) * std::size_t(window.width) + std::size_t(column),
                       {},
                       ray_length(view, column, row)};
    for (std::size_t axis = 0; axis < 3 && pixel.at + axis * pixels < depth.size(); axis++)
      pixel.values[axis] = depth[pixel.at + axis * pixels];
    visit(pixel);
  }
}

}  // namespace alcove
