// Tells what was done to normals that have the lengths of no vectors.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/frame/depth.h"

namespace alcove {

/// Gives what was done to signed normals or to 0.5 + 0.5 n if undoing it gives nearly all of them unit length: a
/// picture's curve, or an exposure. It ends a sentence that begins with "they look like". `normal` has three planes.
std::optional<std::string> alteration_of(std::span<const float> normal, std::span<const float> raw,
                                         const DepthMap& map);

}  // namespace alcove
