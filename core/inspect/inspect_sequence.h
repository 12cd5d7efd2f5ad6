// What changes along a sequence of frames.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/base/settings.h"
#include "core/inspect/inspection.h"

namespace alcove {

/// The frames that a sequence is told of, and their files.
struct SequenceNames {
  InputSettings named;                   // as the user gave them, with places for the frame number
  std::vector<int> frames;               // those that there are, in order, at least one
  std::vector<int> absent;               // those that were asked for, or lie between them, and are not there
  std::vector<int> evidence;             // some of them, by one of which a run decides how all are read
  std::string said;                      // --frames, or empty
  std::function<InputSettings(int)> of;  // the settings with the files of one frame
};

/// Inspects the frame by which a run would decide how all are read, and adds what changes along the sequence: by the
/// headers of all frames, and by the pixels of a few. Fails as inspect_frame() does for that frame; what is wrong with
/// others is part of the answer.
Inspection inspect_sequence(const SequenceNames& names);

}  // namespace alcove
