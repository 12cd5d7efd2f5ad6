// Whether two frames of a shot show one scene, or there is a cut between them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/run/shot.h"

namespace alcove {

/// Whether each frame sees past more of what the other one shows than it sees the same: sets that lie at the same place
/// of the world, before and behind a cut. Frames that see nothing of each other are not told of: neither harms the
/// other. Looks at a grid of pixels of both.
bool is_cut_between(const EstimatedFrame& a, const EstimatedFrame& b);

}  // namespace alcove
