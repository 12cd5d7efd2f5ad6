// Pixels followed one frame back.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/flicker.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/measure/metrics.h"

namespace alcove {
namespace {

/// The pixel of the previous frame that shows what pixel (x, y) shows.
std::optional<std::size_t> earlier_place(const ErrorFrame& previous, const ErrorFrame& here, int x, int y) {
  const std::size_t i = std::size_t(y) * std::size_t(here.width) + std::size_t(x);
  double earlier_x = x, earlier_y = y;
  if (!here.motion_x.empty()) {
    earlier_x = std::round(x + double(here.motion_x[i]));
    earlier_y = std::round(y - double(here.motion_y[i]));
  }
  if (!(earlier_x >= 0 && earlier_x < here.width && earlier_y >= 0 && earlier_y < here.height)) return std::nullopt;
  const std::size_t earlier = std::size_t(earlier_y) * std::size_t(here.width) + std::size_t(earlier_x);
  if (!previous.mask[earlier]) return std::nullopt;
  if (!here.depth.empty() && !previous.depth.empty()) {
    const double a = here.depth[i], b = previous.depth[earlier];
    if (!(std::abs(a - b) <= kDepthStep * std::min(a, b))) return std::nullopt;
  }
  return earlier;
}

}  // namespace

void Flicker::add(const ErrorFrame& previous, const ErrorFrame& here) {
  const std::size_t pixels = here.mask.size();
  for (int y = 0; y < here.height; y++)
    for (int x = 0; x < here.width; x++) {
      const std::size_t i = std::size_t(y) * std::size_t(here.width) + std::size_t(x);
      if (!here.mask[i]) continue;
      const auto earlier = earlier_place(previous, here, x, y);
      if (!earlier) continue;
      for (std::size_t plane = 0; plane < here.error.size(); plane += pixels) {
        const double a = double(here.error[plane + i]) - previous.error[plane + *earlier];
        const double b =
            here.error_b.empty() ? a : double(here.error_b[plane + i]) - previous.error_b[plane + *earlier];
        square_ += a * b;
        count_++;
      }
    }
}

double Flicker::rms() const { return count_ ? std::sqrt(std::max(0.0, square_ / double(count_))) : 0; }

}  // namespace alcove
