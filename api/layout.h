// Planes of the caller's, however they lie, and ours, one component behind the other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "api/alcove/alcove.h"

namespace alcove {

/// Fails with ErrorKind::usage, calling the plane by its name, on a layout that is none: no pixels or too many, no
/// components, an unknown type, or strides by which values share bytes.
void check_layout(const std::string& name, const alcove_layout& layout);

/// Copies the caller's values. The layout was checked.
std::vector<float> planes_from(const void* data, const alcove_layout& layout);

/// Copies as many planes as the layout has components into the caller's memory; half floats are rounded to the nearest,
/// to even.
void planes_to(std::span<const float> planes, void* data, const alcove_layout& layout);

}  // namespace alcove
