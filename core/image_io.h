// Images that are no EXR, through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/chart.h"
#include "core/image.h"

namespace alcove {

/// All channels of a picture's first image, as they are stored: integer formats become 0 to 1, no colour is converted, no alpha multiplied in.
/// Its windows are where the file says, from 0, 0 for most formats. Fails with ErrorKind::input; `option` is for the message.
Image read_image(const std::string& path, const char* option);

/// An 8-bit PNG from interleaved display values in [0, 1] (clamped); 1 or 3 channels. `name` is for the message of a failure, ErrorKind::output.
std::vector<char> encode_png(const std::string& name, int width, int height, int channels, std::span<const float> pixels);

/// An 8-bit colour PNG of a chart. Fails with ErrorKind::output, also where the font for its texts is missing.
std::vector<char> encode_chart(const std::string& name, const Chart& chart);

/// Writes an 8-bit PNG, whole or not at all, from interleaved display values in [0, 1] (clamped); 1 or 3 channels.
/// Fails with ErrorKind::output.
void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels);

}  // namespace alcove
