// The pictures of a frame: its preview and its debug views.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/chain.h"
#include "core/formats/color.h"
#include "core/run/frame_files.h"

namespace alcove {

/// Writes the preview and the debug views of a frame that was computed at once, over source.data; each picture is
/// written whole or not at all. `transform` is for the preview of a composite, and may be null. Fails with
/// ErrorKind::output.
void write_pictures(FrameSource& source, const FrameOutputs& outputs, const DisplayTransform* transform,
                    const OutputSettings& settings, const Provenance& provenance);

}  // namespace alcove
