// What a frame estimates by itself: what it hands to others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/filters/filters.h"

namespace alcove {

/// Buffers that the host reads after the recorder has run.
struct OwnEstimate {
  GBuffer gbuffer;
  Visibility visibility;  // of all its pixels, before any shaping
};

}  // namespace alcove
