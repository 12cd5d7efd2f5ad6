// Pictures of debug views: how numbers become colours with a scale below them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "core/chain/debug_view.h"

namespace alcove {

/// Writes the picture, whole or not at all. `values`: one number per pixel, kSkyDepth for sky. made_by: see
/// encode_png(). Fails with ErrorKind::output.
void write_debug_view(const std::string& path, const DebugView& view, int width, int height,
                      std::span<const float> values, const std::string& made_by);

}  // namespace alcove
