// The files that a frame is read from, by the settings that name them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/settings.h"

namespace alcove {

/// The file that a frame is called after: its INPUT, or else its depth, its positions or its deep samples.
const std::string& main_input(const InputSettings& settings);

/// Whether the frame's normals are read; `--normal none` leaves them out.
bool wants_normals(const InputSettings& settings);

/// Whether AO is wanted in parts of the frame only.
bool wants_matte(const InputSettings& settings);

/// Whether a text names a picture by its ending, rather than objects.
bool names_picture(const std::string& text);

/// Whether some surfaces are no occluders.
bool chooses_occluders(const InputSettings& settings);

/// Whether --deep names a file.
bool has_deep(const InputSettings& settings);

/// Whether anything is named that may show more than the first surface of each pixel.
bool has_hidden_sources(const InputSettings& settings);

/// All files that a frame reads; empty names where it has none.
std::vector<std::string> input_files(const InputSettings& settings);

}  // namespace alcove
