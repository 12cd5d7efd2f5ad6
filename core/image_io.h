// Images that are no EXR, through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

namespace alcove {

/// Writes an 8-bit PNG, whole or not at all, from interleaved display values in [0, 1] (clamped); 1 or 3 channels.
/// Fails with ErrorKind::output.
void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels);

}  // namespace alcove
