// Says why no camera sees points where their pixels are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/frame/camera/resection.h"

namespace alcove {

/// Says that components of the points were cut off at 0 or another value, as formats without sign do; "" if not.
std::string why_cut(std::span<const SeenPoint> points, const Window& display);

/// Says that each axis was stretched by itself, as where a bounding box is mapped to 0 .. 1; "" if not. `camera`: the
/// one that sees the points all the same, if any does; its pixels are as wide as its numbers say, and `pixel_aspect` as
/// the file says.
std::string why_stretched(std::span<const SeenPoint> points, const Window& display, const Resection* camera,
                          double pixel_aspect);

/// Says that the lens bends lines: each point lies in the right direction from the picture's middle, and at another
/// distance. "" if not.
std::string why_bent(std::span<const SeenPoint> points, const Window& display);

}  // namespace alcove
