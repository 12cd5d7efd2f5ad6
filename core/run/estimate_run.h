// The estimate of one frame for others: read and estimated, whole or in tiles, but neither filtered nor written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/run/shared_estimates.h"

namespace alcove {

/// Estimates a frame of the plan. `settled`: another one that it is read as, or null; `shot`: what frames see of each
/// other, or null. `read`: gets what was read of the frame. Fails as computing the frame does.
EstimatedFrame estimate_frame(const EstimateRoom& where, const FramePlan& plan, const FrameSource* settled,
                              SharedFrames* shot, int frame, PreparedOthers& took, ReadPlanes& read);

}  // namespace alcove
