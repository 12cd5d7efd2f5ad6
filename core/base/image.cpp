// Windows of pixels, and pictures of the host.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/image.h"

#include <algorithm>
#include <cstdint>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {

std::string to_string(const Window& window) {
  return fmt::format("{}x{} at ({}, {})", window.width, window.height, window.x, window.y);
}

std::vector<float> cropped(std::span<const float> planes, const Window& from, const Window& to) {
  std::vector<float> part;
  put_in(planes, from, to, to, part);
  return part;
}

Image::Image(const Window& data_window, const Window& display_window, std::vector<std::string> plane_names)
    : data(data_window), display(display_window), names(std::move(plane_names)), pixels(data.pixels() * names.size()) {}

std::span<float> Image::plane(std::size_t index) { return {pixels.data() + index * data.pixels(), data.pixels()}; }

std::span<const float> Image::plane(std::size_t index) const {
  return {pixels.data() + index * data.pixels(), data.pixels()};
}

std::span<const float> Image::plane(std::string_view name) const {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) fail(ErrorKind::input, "there is no plane {}; there is {}", name, list_of(names));
  return plane(std::size_t(found - names.begin()));
}

namespace {

int divided_down(std::int64_t number, int by) { return int(number >= 0 ? number / by : -((by - 1 - number) / by)); }

/// The first block whose pixel at `place` within it lies at x or farther right.
int first_block(std::int64_t x, int origin, int place, int factor) {
  return divided_down(x - origin - place + factor - 1, factor);
}

// Headers may put windows anywhere, so sums need 64 bits.
std::int64_t right_of(const Window& window) { return std::int64_t(window.x) + window.width; }
std::int64_t below(const Window& window) { return std::int64_t(window.y) + window.height; }

int middle_of(int factor) { return factor / 2; }

/// The window of blocks from `left`, `top` to before `right`, `bottom`.
Window of_blocks(int left, int top, int right, int bottom, const Window& display, int factor) {
  return {divided_down(display.x, factor) + left, divided_down(display.y, factor) + top, right - left, bottom - top};
}

}  // namespace

Window common_part(const Window& a, const Window& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  const std::int64_t right = std::min(right_of(a), right_of(b));
  const std::int64_t bottom = std::min(below(a), below(b));
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

Window reduced(const Window& window, const Window& display, int factor) {
  const auto first = [&](std::int64_t x, int origin) { return first_block(x, origin, middle_of(factor), factor); };
  return of_blocks(first(window.x, display.x), first(window.y, display.y), first(right_of(window), display.x),
                   first(below(window), display.y), display, factor);
}

Window enlarged(const Window& small, const Window& display, int factor) {
  constexpr std::int64_t kFarthest = 1 << 30;  // px; no file has a window that reaches farther
  const auto corner = [&](std::int64_t x, int origin) {
    return std::clamp(origin + (x - divided_down(origin, factor)) * factor, -kFarthest, kFarthest);
  };
  const std::int64_t left = corner(small.x, display.x), top = corner(small.y, display.y);
  return {int(left), int(top), int(corner(right_of(small), display.x) - left),
          int(corner(below(small), display.y) - top)};
}

Window covering(const Window& window, const Window& display, int factor) {
  const auto begin = [&](std::int64_t x, int origin) { return first_block(x, origin, factor - 1, factor); };
  const auto end = [&](std::int64_t x, int origin) { return first_block(x, origin, 0, factor); };
  return of_blocks(begin(window.x, display.x), begin(window.y, display.y), end(right_of(window), display.x),
                   end(below(window), display.y), display, factor);
}

std::vector<float> middle_pixels(std::span<const float> plane, const Window& window, const Window& display,
                                 int factor) {
  const Window small = reduced(window, display, factor);
  const Window blocks = enlarged(small, display, factor);
  std::vector<float> pixels;
  pixels.reserve(small.pixels());
  for (int row = 0; row < small.height; row++) {
    const int y = blocks.y + row * factor + middle_of(factor) - window.y;
    const int x = blocks.x + middle_of(factor) - window.x;
    const float* from = plane.data() + std::size_t(y) * std::size_t(window.width) + std::size_t(x);
    for (int column = 0; column < small.width; column++) pixels.push_back(from[column * factor]);
  }
  return pixels;
}

void copy_enlarged(const float* from, const Window& small, float* to, const Window& to_window, const Window& display,
                   int factor) {
  if (factor == 1) return copy_common(from, small, to, to_window);
  const Window blocks = enlarged(small, display, factor);
  const Window part = common_part(blocks, to_window);
  for (int y = part.y; y < part.y + part.height; y++) {
    const float* row = from + std::size_t((y - blocks.y) / factor) * std::size_t(small.width);
    float* const to_row = to + std::size_t(y - to_window.y) * std::size_t(to_window.width);
    for (int x = part.x; x < part.x + part.width; x++) to_row[x - to_window.x] = row[(x - blocks.x) / factor];
  }
}

}  // namespace alcove
