// Says why a name with a place for a frame number may fit no file.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/formats/sequence.h"

namespace alcove {

/// Gives what is wrong with a name that no file has: a token of another program or a range in it. "" if it has
/// none of these.
std::string foreign_pattern_in(const std::string& name);

/// Gives the same of a pattern that fits no file, or else which files there are: with another number of digits, or with
/// another ending or separator. Begins with ": "; "" if nothing tells.
std::string why_no_frames(const FramePattern& pattern);

}  // namespace alcove
