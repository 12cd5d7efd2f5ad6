// Says why no camera sees points where their pixels are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/frame/camera/resection.h"

namespace alcove {

/// Explains that components of the points were cut off at 0 or another value, as in formats without sign; "" if they
/// were not.
std::string why_cut(std::span<const SeenPoint> points, const Window& display);

/// Explains that each axis was stretched by itself, as when a bounding box is mapped to 0 .. 1; "" if it was not.
/// `camera`: a camera that fits the points all the same, or null. Its pixels have the aspect of its own numbers, and
/// `pixel_aspect` is the file's.
std::string why_stretched(std::span<const SeenPoint> points, const Window& display, const Resection* camera,
                          double pixel_aspect);

/// Explains that the lens bends lines: each point lies in the right direction from the picture's middle, but at another
/// distance. "" if it does not.
std::string why_bent(std::span<const SeenPoint> points, const Window& display);

}  // namespace alcove
