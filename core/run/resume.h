// Finds out whether an earlier run has left a frame whole.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"

namespace alcove {

/// Tells the contents of a frame's input files from others, wherever they lie: a hash of the size, the beginning and
/// the end of each. The beginning of an EXR file holds the places of all its chunks. Never fails: a file that cannot be
/// read counts as empty.
std::string identity_of_inputs(const Settings& frame);

/// Whether all outputs of a frame are there and whole, made with the options of this digest from inputs of this
/// identity, and no older than them. `frame` names the files of one frame. Reads headers and the table of chunks; never
/// fails.
bool has_whole_outputs(const Settings& frame, const std::string& options_digest);

}  // namespace alcove
