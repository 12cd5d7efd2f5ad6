// Host pixels: named float planes over a data window, within a display window. A value type.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace alcove {

/// A rectangle of pixels: x right, y down, (x, y) its upper left pixel.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const Window&) const = default;
  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
};
std::string to_string(const Window& window);

/// Cuts out of planes over `from` the part that lies over `to`, which must be within it.
std::vector<float> cropped(std::span<const float> planes, const Window& from, const Window& to);

struct Image {
  Window data;                     // where there are pixels
  Window display;                  // what the picture shows; the projection refers to it
  std::vector<std::string> names;  // full channel names, one per plane
  std::vector<float> pixels;       // plane by plane, row by row from the top

  Image() = default;
  /// Planes of zeros.
  Image(const Window& data, const Window& display, std::vector<std::string> names);
  /// Planes of zeros whose data and display windows are 0, 0, width, height.
  Image(int width, int height, std::vector<std::string> names);

  std::span<float> plane(std::size_t index);
  std::span<const float> plane(std::size_t index) const;
  /// Gives the plane of that name. Fails with ErrorKind::input, listing the planes that there are.
  std::span<const float> plane(std::string_view name) const;
};

}  // namespace alcove
