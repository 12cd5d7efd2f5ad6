// The precision of depth values, from files or from memory, and what a walk over settled planes shows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "core/base/image.h"
#include "core/base/note.h"
#include "core/frame/evidence.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/reading.h"

namespace alcove {

/// Measures how the depth of a window was rounded, and takes it down in `reading`: it changes how the values are
/// judged, and how near occluders may be. Positions are not measured. Fails with ErrorKind::input, calling the depth
/// `name`, if it holds 256 values at most, as a grey picture does.
Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name);

/// Takes down the step of depth between planes that was stored as integers. The kind of the depth must be settled.
void measure_levels(Reading& reading, std::span<const float> depth);

/// Notes half floats, called `name`, whose sky may be surfaces: those beyond the largest number became infinite.
Notes overflown_depth(const Reading& reading, std::span<const float> depth, const std::string& name);

/// Gives what the pixels of a window show, for detectors. Depth is settled in `reading`, and called `name`;
/// `has_read_normals` says that the normals are settled, too.
Findings findings_of(const Reading& reading, const Window& window, std::span<const float> depth,
                     std::span<const float> normal, const Evidence& seen, const std::string& name,
                     bool has_read_normals);

}  // namespace alcove
