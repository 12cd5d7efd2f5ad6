// Windows of pixels, and pictures of the host: named float planes over a data window, within a display window.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
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

/// Cuts planes over `from` down to `to`, which must lie within it.
std::vector<float> cropped(std::span<const float> planes, const Window& from, const Window& to);

struct Image {
  Window data;                     // the pixels
  Window display;                  // the visible picture; the projection refers to it
  std::vector<std::string> names;  // full channel names, one per plane
  std::vector<float> pixels;       // plane by plane, row by row from the top

  Image() = default;
  /// Makes planes of zeros.
  Image(const Window& data, const Window& display, std::vector<std::string> names);

  std::span<float> plane(std::size_t index);
  std::span<const float> plane(std::size_t index) const;
  /// Gives the plane of that name. Fails with ErrorKind::input, listing all names.
  std::span<const float> plane(std::string_view name) const;
};

/// The pixels that both windows have; an empty window if they share none.
Window common_part(const Window& a, const Window& b);

/// Copies the pixels that both windows have from one plane into the other.
void copy_common(const float* from, const Window& from_window, float* to, const Window& to_window);

/// Copies a part of planes over `from` into planes over `whole`. `all` is resized to hold them.
template <class T>
void put_in(std::span<const T> planes, const Window& from, const Window& part, const Window& whole,
            std::vector<T>& all) {
  const std::size_t count = planes.size() / from.pixels(), width = std::size_t(part.width);
  all.resize(count * whole.pixels());
  for (std::size_t k = 0; k < count; k++)
    for (int y = part.y; y < part.y + part.height; y++) {
      const auto place = [&](const Window& of) {
        return k * of.pixels() + std::size_t(y - of.y) * std::size_t(of.width) + std::size_t(part.x - of.x);
      };
      std::copy_n(planes.begin() + std::ptrdiff_t(place(from)), width, all.begin() + std::ptrdiff_t(place(whole)));
    }
}

// Below, each pixel of a smaller picture is a block of `factor` x `factor` pixels of a larger one, counted from the
// upper left corner of the larger display window. The smaller display window begins at that corner divided by `factor`,
// rounded down.

/// The pixels of the smaller picture whose middle lies in the window. Of two middle pixels the one to the right and
/// below counts.
Window reduced(const Window& window, const Window& display, int factor);
/// The pixels of the larger picture that make up a window of the smaller one.
Window enlarged(const Window& small, const Window& display, int factor);
/// The window of the smaller picture whose blocks cover a window.
Window covering(const Window& window, const Window& display, int factor);

/// The middle pixels of the blocks of a plane over `window`, as a plane over its reduced() window.
std::vector<float> middle_pixels(std::span<const float> plane, const Window& window, const Window& display, int factor);
/// Copies each pixel of a plane over `small` to the pixels of its block that `to_window` has.
void copy_enlarged(const float* from, const Window& small, float* to, const Window& to_window, const Window& display,
                   int factor);

}  // namespace alcove
