// What frames of the shot have estimated, as one of them takes it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/gpu/recorder.h"
#include "kernels/time/accumulate.h"

namespace alcove {

/// Other frames, in upload buffers.
struct SeenGroup {
  const gpu::Buffer* planes = nullptr;  // of all of them, as words
  const gpu::Buffer* frames = nullptr;  // TakenFrame each
  uint count = 0;
  // Entries of the table. Kernels are made for their number, so that it is the same where fewer frames count, at cuts
  // and beside missing ones: those beyond `count` repeat the first one and count nowhere.
  uint listed = 0;
};

/// The estimates that a frame takes the mean of.
struct EstimateSet {
  // Its own, over all of it, in upload buffers: planar depth as of a TakenFrame, normals as of a GBuffer, and values:
  // the visibility, then that of each radius where it is asked for, then the mean open direction where that is. Null:
  // it is its own estimate.
  const gpu::Buffer* depth = nullptr;
  const gpu::Buffer* normal = nullptr;
  const gpu::Buffer* values = nullptr;
  View view{};                    // of all of it
  bool has_moving = false;        // some frame has pixels that move by motion vectors
  std::vector<SeenGroup> groups;  // of the others
  ivec2 corner{};                 // px from the whole frame's corner to that of the part that is computed
  bool is_further_part = false;   // of the frame of the part before, by the same recorder: what has moved is known
};

}  // namespace alcove
