// PNG pictures out: previews, debug views, pages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace alcove {

/// Display values of sky in pictures: no grey, not on the colour ramp of debug views, and no normal that faces the
/// camera.
inline constexpr std::array kSkyColor{0.74f, 0.4f, 0.36f};

/// Encodes an 8-bit PNG from interleaved display values in [0, 1] (clamped); 1 or 3 channels, rows from the top. Fails
/// with ErrorKind::output, whose message begins with `name`. `made_by` and `shows` are texts that the PNG keeps, the
/// second as its description; an empty one is left out.
std::vector<char> encode_png(const std::string& name, int width, int height, int channels,
                             std::span<const float> pixels, const std::string& made_by = "",
                             const std::string& shows = "");

/// Writes what encode_png() gives, whole or not at all. Fails with ErrorKind::output.
void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels,
               const std::string& made_by = "", const std::string& shows = "");

/// Tells whether the file is a PNG of write_png() that has this text and was not cut short.
bool is_whole_png(const std::string& path, const std::string& made_by);

}  // namespace alcove
