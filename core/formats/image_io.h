// Images that are no EXR, through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/formats/chart.h"
#include "core/formats/picture_reader.h"

namespace alcove {

/// Fails with ErrorKind::input, also where a header claims more pixels than its file can hold; `option` is for the
/// message.
std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option);

/// An 8-bit PNG from interleaved display values in [0, 1] (clamped); 1 or 3 channels. `name` is for the message of a
/// failure, ErrorKind::output. made_by: a text that is kept in it; empty: none.
std::vector<char> encode_png(const std::string& name, int width, int height, int channels,
                             std::span<const float> pixels, const std::string& made_by = "");

/// An 8-bit colour PNG of a chart. Fails with ErrorKind::output, also where the font for its texts is missing.
std::vector<char> encode_chart(const std::string& name, const Chart& chart);

/// Writes an 8-bit PNG, whole or not at all, from interleaved display values in [0, 1] (clamped); 1 or 3 channels.
/// Fails with ErrorKind::output.
void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels,
               const std::string& made_by = "");

/// Whether a PNG of write_png() has that text and was not cut short.
bool is_whole_png(const std::string& path, const std::string& made_by);

}  // namespace alcove
