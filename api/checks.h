// Whether planes from memory fit each other: what is certainly wrong is refused, what may be is noted.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/chain/compute.h"
#include "core/frame/reading.h"

namespace alcove {

/// Looks at a part of the pixels. Fails with ErrorKind::input where every depth is negative, where positions do not lie
/// on the rays of their pixels, and where the normals, as they are read, are not those of the depth; gives sentences
/// where they may not be, and where the radii do not suit the frame. Some pixels decide nothing.
Notes check_planes(const Reading& reading, const HostPlanes& planes, const EstimatorSettings& settings);

}  // namespace alcove
