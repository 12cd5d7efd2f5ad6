// Walks over strides, and converts half floats.
// SPDX-License-Identifier: BSD-3-Clause
#include "api/session.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/half.h"

namespace alcove {
namespace {

constexpr int kMostSide = 1 << 24, kMostComponents = 64;
// Bytes. By the largest side, and three times that, it is a ptrdiff_t still.
constexpr std::ptrdiff_t kMostStride = std::numeric_limits<std::ptrdiff_t>::max() / kMostSide / 4;

std::size_t bytes_of(int type) { return type == ALCOVE_HALF ? 2 : 4; }

struct Strides {
  std::ptrdiff_t pixel, row, component;
};

Strides strides_of(const alcove_layout& layout) {
  const auto bytes = std::ptrdiff_t(bytes_of(layout.type));
  Strides strides{layout.pixel_stride, layout.row_stride, layout.component_stride ? layout.component_stride : bytes};
  if (!strides.pixel) strides.pixel = bytes * layout.components;
  if (!strides.row) strides.row = strides.pixel * layout.width;
  return strides;
}

/// Calls use(place, byte, stride) for each row of each component, in our order.
template <class Byte, class Use>
void for_rows(Byte* data, const alcove_layout& layout, const Use& use) {
  const Strides strides = strides_of(layout);
  std::size_t place = 0;
  for (int c = 0; c < layout.components; c++)
    for (int y = 0; y < layout.height; y++, place += std::size_t(layout.width))
      use(place, data + c * strides.component + y * strides.row, strides.pixel);
}

}  // namespace

void check_layout(const std::string& name, const alcove_layout& layout) {
  if (layout.width < 1 || layout.height < 1 || layout.width > kMostSide || layout.height > kMostSide)
    fail(ErrorKind::usage, "{}: a plane of {} x {} pixels", name, layout.width, layout.height);
  if (layout.components < 1 || layout.components > kMostComponents)
    fail(ErrorKind::usage, "{}: a plane of {} components", name, layout.components);
  constexpr std::int64_t kMostValues = std::int64_t(1) << 32;  // more than a buffer of any device holds
  if (std::int64_t(layout.width) * layout.height > kMostValues / layout.components)
    fail(ErrorKind::usage, "{}: a plane of {} x {} x {} values, more than any device takes", name, layout.width,
         layout.height, layout.components);
  if (layout.type != ALCOVE_FLOAT && layout.type != ALCOVE_HALF)
    fail(ErrorKind::usage, "{}: a plane of type {}, which is neither ALCOVE_FLOAT nor ALCOVE_HALF", name, layout.type);
  const auto is_endless = [](std::ptrdiff_t stride) { return stride < -kMostStride || stride > kMostStride; };
  if (is_endless(layout.component_stride) || is_endless(layout.pixel_stride) || is_endless(strides_of(layout).row))
    fail(ErrorKind::usage,
         "{}: strides of {}, {} and {} bytes from component, pixel and row to the next: beyond memory", name,
         layout.component_stride, layout.pixel_stride, layout.row_stride);
  // From the shortest stride on, each must reach beyond all that lies within it.
  const Strides strides = strides_of(layout);
  std::array<std::pair<std::int64_t, int>, 3> steps{
      std::pair<std::int64_t, int>{std::abs(strides.component), layout.components},
      {std::abs(strides.pixel), layout.width},
      {std::abs(strides.row), layout.height}};
  std::ranges::sort(steps);
  auto extent = std::int64_t(bytes_of(layout.type));
  for (const auto& [stride, count] : steps) {
    if (count > 1 && stride < extent)
      fail(ErrorKind::usage, "{}: a stride of {} bytes over values of {} bytes: strides are in bytes, 0 is packed",
           name, stride, extent);
    extent += stride * (count - 1);
  }
}

std::vector<float> planes_from(const void* data, const alcove_layout& layout) {
  const auto width = std::size_t(layout.width);
  std::vector<float> planes(width * std::size_t(layout.height) * std::size_t(layout.components));
  for_rows(static_cast<const std::byte*>(data), layout,
           [&](std::size_t place, const std::byte* from, std::ptrdiff_t stride) {
             for (std::size_t x = 0; x < width; x++) {
               const std::byte* const at = from + std::ptrdiff_t(x) * stride;
               std::uint16_t half = 0;
               if (layout.type == ALCOVE_FLOAT)
                 std::memcpy(&planes[place + x], at, sizeof(float));
               else
                 std::memcpy(&half, at, sizeof half), planes[place + x] = from_half(half);
             }
           });
  return planes;
}

void planes_to(std::span<const float> planes, void* data, const alcove_layout& layout) {
  const auto width = std::size_t(layout.width);
  for_rows(static_cast<std::byte*>(data), layout, [&](std::size_t place, std::byte* to, std::ptrdiff_t stride) {
    for (std::size_t x = 0; x < width; x++) {
      std::byte* const at = to + std::ptrdiff_t(x) * stride;
      const float value = planes[place + x];
      const std::uint16_t half = layout.type == ALCOVE_FLOAT ? std::uint16_t(0) : to_half(value);
      if (layout.type == ALCOVE_FLOAT)
        std::memcpy(at, &value, sizeof value);
      else
        std::memcpy(at, &half, sizeof half);
    }
  });
}

}  // namespace alcove
