// Host pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/image.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/base/windows.h"

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

Image::Image(int width, int height, std::vector<std::string> plane_names)
    : Image({0, 0, width, height}, {0, 0, width, height}, std::move(plane_names)) {}

std::span<float> Image::plane(std::size_t index) { return {pixels.data() + index * data.pixels(), data.pixels()}; }

std::span<const float> Image::plane(std::size_t index) const {
  return {pixels.data() + index * data.pixels(), data.pixels()};
}

std::span<const float> Image::plane(std::string_view name) const {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) fail(ErrorKind::input, "there is no plane {}; there is {}", name, list_of(names));
  return plane(std::size_t(found - names.begin()));
}

}  // namespace alcove
