// Alterations of normals that destroy their unit length.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/frame/find/frame_source.h"

namespace alcove {

/// Names the alteration of signed normals or of 0.5 + 0.5 n if undoing it gives nearly all of them unit length: a
/// picture's curve, or an exposure. It ends a sentence that begins with "they look like". Normals have three planes.
std::optional<std::string> alteration_of(const RawPart& raw, const DepthMap& map);

}  // namespace alcove
