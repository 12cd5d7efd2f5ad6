// Completed surfaces: where a surface goes on straight although the picture does not show it.
// SPDX-License-Identifier: BSD-3-Clause
//
// docs/completion.md has the rules and why a completed surface is a straight segment.
#pragma once

#include <vector>

#include "core/reference/reference_slice.h"

namespace alcove {

/// The part of a completed surface that lies in the sphere of the radius.
struct CompletedSegment {
  Vector nearer, farther;  // its ends, offsets from the receiver; the nearer one is fewer steps away on the image
  double thickness = 0;    // of the run that it goes on from
};

std::vector<CompletedSegment> completed_segments(const ReferenceScene& scene, const ReferenceReceiver& receiver,
                                                 const ReferenceSide& side, const ReferenceLine& line,
                                                 const ReferenceSettings& settings);

}  // namespace alcove
