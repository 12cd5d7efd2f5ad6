// Pictures that no plane of projection shows: panoramas and fish eyes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "core/frame/resection.h"

namespace alcove {

/// Which panorama has points where their pixels are, in words; "" where none of those that are tried does: the whole
/// sphere and half of it in longitude and latitude, cylinders, and fish eyes. It need not be upright. For points that
/// no camera sees.
std::string panorama_of(std::span<const SeenPoint> points, const Window& display);

/// Fails with ErrorKind::input: the file holds a panorama, as `by` says.
[[noreturn]] void refuse_panorama(const std::string& path, const std::string& by);

}  // namespace alcove
