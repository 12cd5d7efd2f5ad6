// The command line that reads a frame as it was understood.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/frame/gbuffer.h"

namespace alcove {

/// What a run is told of files and frames.
struct CommandNames {
  InputSettings inputs;  // whose files and cameras it names
  std::string output = "ao.exr";
  std::string frames = {};  // a list, or empty
};

/// The run that reads the settled frame as it was understood, every guess made explicit. Without a camera or a radius
/// to propose it holds a word to be replaced.
std::string command_of(const FrameSource& source, const CommandNames& names, bool has_camera);

/// The word of --normal-encoding for the normals of a settled frame.
const char* encoding_name(const FrameSource& source);

}  // namespace alcove
