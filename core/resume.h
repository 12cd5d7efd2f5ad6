// What an earlier run has left of a frame: whole, or to be made anew.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/settings.h"

namespace alcove {

/// Whether all outputs of a frame are there and whole, made with the options of this digest, and no older than what they are made from. `frame` names the
/// files of one frame. Reads headers and the table of chunks; never fails.
bool has_whole_outputs(const Settings& frame, const std::string& options_digest);

}  // namespace alcove
