// A region of a frame: what of its surroundings the AO within it depends on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/gbuffer.h"
#include "core/settings.h"

namespace alcove {

/// Settles the frame by all of its pixels, then narrows source.data to settings.input.roi and as much around it as occluders, and the filters of the
/// settings, can reach; source.region is what is to be written. Within it AO is what it is without a region.
/// Fails with ErrorKind::usage where the region is not within the data window.
void restrict_to_region(FrameSource& source, const Settings& settings);

}  // namespace alcove
