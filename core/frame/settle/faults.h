// Faults of a frame's files that its headers and the lengths of its normals show.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/note.h"
#include "core/frame/find/frame_source.h"

namespace alcove {

/// Gives one sentence for each: shortened normals, channels that a lossy codec has damaged, other parts that are cut
/// short or have other windows, overscan and crops. The frame's meaning is settled.
Notes faults_of(FrameSource& source, const RawPart& raw);

/// Whether the normals are vectors in x, y and z, so that they have lengths.
bool has_lengths(const FrameSource& source);

}  // namespace alcove
