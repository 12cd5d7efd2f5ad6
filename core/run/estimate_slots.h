// The upload buffers of a lane that frames' estimates are put into.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/seen_estimates.h"
#include "core/run/shot.h"

namespace alcove {

/// What is there for one frame is there for the next.
class EstimateSlots {
 public:
  /// Gives the estimates as the frame takes them, for any number of parts of it; none where there are none. No buffer
  /// is larger than `most_bytes`.
  EstimateSet filled(gpu::Recorder& gpu, const FramePlan& plan, const TakenEstimates& taken, int frame,
                     std::uint64_t most_bytes);

 private:
  using Estimated = std::weak_ptr<const EstimatedFrame>;  // tells whether it is the same one, and keeps none
  struct Group {
    const std::byte* buffer = nullptr;  // where it was
    std::size_t stride = 0;             // words of a slot
    std::vector<Estimated> held;        // by slot
  };
  std::vector<Group> groups_;
};

}  // namespace alcove
