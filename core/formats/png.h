// Writes PNG pictures: previews, debug views, pages. core/formats/image_io.h reads them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace alcove {

/// The display colour of sky in pictures: not a grey, not on the colour ramp of debug views, and not the colour of a
/// normal that faces the camera.
inline constexpr std::array kSkyColor{0.74f, 0.4f, 0.36f};

/// Encodes an 8-bit PNG from interleaved display values in [0, 1] (clamped); 1 or 3 channels, rows from the top. The
/// PNG keeps the text `made_by`, and `shows` as its description; empty ones are left out. Fails with ErrorKind::output
/// and a message that begins with `name`.
std::vector<char> encode_png(const std::string& name, int width, int height, int channels,
                             std::span<const float> pixels, const std::string& made_by = "",
                             const std::string& shows = "");

/// Writes the PNG of encode_png() to a file, whole or not at all. Fails with ErrorKind::output.
void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels,
               const std::string& made_by = "", const std::string& shows = "");

/// Whether the file is a PNG of write_png() with this text that was not cut short.
bool is_whole_png(const std::string& path, const std::string& made_by);

}  // namespace alcove
