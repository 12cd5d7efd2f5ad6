// What two windows share.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/windows.h"

#include <algorithm>
#include <cstdint>

namespace alcove {

Window common_part(const Window& a, const Window& b) {
  // Headers may put windows anywhere.
  const auto end = [](int start, int length) { return std::int64_t(start) + length; };
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  const std::int64_t right = std::min(end(a.x, a.width), end(b.x, b.width));
  const std::int64_t bottom = std::min(end(a.y, a.height), end(b.y, b.height));
  return right > x && bottom > y ? Window{x, y, int(right - x), int(bottom - y)} : Window{};
}

void copy_common(const float* from, const Window& from_window, float* to, const Window& to_window) {
  const Window part = common_part(from_window, to_window);
  const auto at = [&](const Window& window, int y) {
    return std::size_t(y - window.y) * std::size_t(window.width) + std::size_t(part.x - window.x);
  };
  for (int y = part.y; y < part.y + part.height; y++)
    std::copy_n(from + at(from_window, y), part.width, to + at(to_window, y));
}

}  // namespace alcove
