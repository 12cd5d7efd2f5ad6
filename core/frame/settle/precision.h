// Measures the pixels of planes, from files or from memory: the rounding of depth, and the detectors' findings.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "core/base/image.h"
#include "core/base/note.h"
#include "core/frame/evidence.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/reading.h"

namespace alcove {

/// Measures the rounding of a window's depth and stores it in `reading`: it affects the judgement of values, and the
/// nearest occluders. Positions are not measured. Fails with ErrorKind::input, with `name` for the depth, if it holds
/// 256 values at most, as a grey picture does.
Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name);

/// Takes down the step of depth between planes that was stored as integers. The kind of the depth must be settled.
void measure_levels(Reading& reading, std::span<const float> depth);

/// The findings of a walk over the pixels, for the detectors. The depth, called `name`, is settled; `has_read_normals`
/// says that the normals are.
Findings findings_of(const Reading& reading, const RawPart& raw, const Evidence& seen, const std::string& name,
                     bool has_read_normals);

}  // namespace alcove
