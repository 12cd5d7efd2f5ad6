// How much of an estimate's occlusion is guessed: the part that completed surfaces took.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/estimate/estimate.h"

namespace alcove {

/// Sums for each tile of 8 x 8 pixels the visibility that is taken by completed surfaces, and by all, for the largest
/// radius, at the sites of the widest lattice: see completion.comp. Null where nobody asked for estimate.completed.
gpu::Buffer* completion(gpu::Recorder& gpu, const GBuffer& gbuffer, const Estimate& estimate, const Sites& sites);

}  // namespace alcove
