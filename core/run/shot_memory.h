// How much memory a run takes for what its frames see of each other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/run/memory_plan.h"
#include "core/run/plan.h"

namespace alcove {

/// The number of others that a frame takes at most.
std::size_t most_others(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings);

/// What a frame of the plan takes, and what its lane takes for its others.
FrameMemory memory_with_others(const FramePlan& plan, const FrameSource& frame, const Settings& settings);

/// What the prepared frames take that so many lanes keep, bytes of host memory.
std::uint64_t bytes_of_shot(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings, int lanes);

/// What the estimates take that so many lanes keep for the means of these frames, which are computed in this order:
/// bytes of host memory.
std::uint64_t bytes_of_estimates(const FramePlan& plan, const FrameSource& frame, const Settings& settings,
                                 std::span<const int> frames, int lanes);

/// What is left for the frames themselves.
RunMemory beside_shot(const RunMemory& memory, const FramePlan& plan, const FrameSource& frame,
                      const Settings& settings, std::span<const int> frames, int lanes);

/// Fails with ErrorKind::usage where --memory has no room for the frames around one, naming how many it has room for,
/// and what would be enough; with ErrorKind::device where nobody has said --memory.
void require_room_for_others(const RunMemory& memory, const FramePlan& plan, const FrameSource& frame,
                             const Settings& settings, std::span<const int> frames);

/// Fails with ErrorKind::device where frames that others take from have planes that no buffer of `most_bytes` holds:
/// they are prepared whole, and only frames that are computed are cut into tiles.
void require_buffers_for_others(std::uint64_t most_bytes, const FrameSource& frame, const Settings& settings);

}  // namespace alcove
