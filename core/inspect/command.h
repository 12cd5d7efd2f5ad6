// The command line that reads a frame as it was understood.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/frame/gbuffer.h"

namespace alcove {

/// The run that reads the frame as it was understood, every guess made explicit. Without a camera or a `median`
/// distance it holds a word to be replaced.
std::string command_of(const FrameSource& source, const InputSettings& settings, bool has_camera,
                       std::optional<double> median);

/// The word of --normal-encoding for the normals of a settled frame.
const char* encoding_name(const FrameSource& source);

}  // namespace alcove
