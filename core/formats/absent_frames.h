// Explains why a name with a place for a frame number fits no file.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/formats/sequence.h"

namespace alcove {

/// Explains a name without a file: it holds another program's token, or a range. "" if it holds neither.
std::string foreign_pattern_in(const std::string& name);

/// Explains a pattern without a file in the same way, or names the files that differ in digits, ending or separator.
/// Begins with ": "; "" if there is no explanation.
std::string why_no_frames(const FramePattern& pattern);

}  // namespace alcove
