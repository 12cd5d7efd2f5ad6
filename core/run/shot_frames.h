// The frames of a shot that influence each other, by their numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/run/plan.h"

namespace alcove {

/// takes_frames: whether frames use surfaces or movement of other frames; takes_others: of other frames or views.
bool takes_frames(const InputSettings& settings);
bool takes_others(const InputSettings& settings);

/// The frames that show movement in `frame`.
std::vector<int> witnesses_of(const FramePlan& plan, int frame);
/// The largest number of such frames, with `count` frames to each side.
int most_witnesses(int count);

/// The frames that influence the hidden surfaces of a frame, in order: the frames around it, and their witnesses.
std::vector<int> seen_around(const FramePlan& plan, int frame);

/// All frames that influence a frame, in order: the frames around it, and the frames that show their movement.
std::vector<int> frames_seen_for(const FramePlan& plan, int frame);
/// The distance of the farthest of these frames, in frames of the shot.
int farthest_seen(int count);

/// The numbers of frames of the shot that are prepared and estimated, each once, for frames computed in this order.
struct SharedCounts {
  std::size_t prepared = 0, estimated = 0;
};
SharedCounts shared_counts(const FramePlan& plan, std::span<const int> frames);

}  // namespace alcove
