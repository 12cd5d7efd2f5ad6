// What lies around the picture, as other frames and other views show it: receivers at the border need it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/filters/filters.h"

namespace alcove {

/// The margin of a part of a frame, or of the whole: on each side on which it ends with the frame an eighth of the
/// frame's width, for which other views of it usually have something to show. It does not depend on how a frame is cut.
Margin margin_of(const Window& part, const Window& frame);

/// The frame as it is with its margin; the same one where it has none. Its planes stay those of the frame.
FrameInputs with_margin(const FrameInputs& frame);

/// The G-buffer with an empty margin: all that others show there is behind it.
GBuffer widen(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& wide);
/// Fills the margin of `wide` with the nearest surfaces that others show there, the first plane of `found`, and gives
/// it normals. Those of the frame are there already: at its border the margin must not change them.
void widen(gpu::Recorder& gpu, const GBuffer& prepared, const GBuffer& wide, const FrameInputs& frame,
           const gpu::Buffer& found);

/// Cuts the margin off planes, or returns the same ones where there is none; null stays null.
gpu::Buffer* cut(gpu::Recorder& gpu, const FrameInputs& frame, gpu::Buffer* planes, const std::string& name);
Visibility cut(gpu::Recorder& gpu, const FrameInputs& frame, const Visibility& wide);
/// The same for a G-buffer whose first surface `prepared` has.
GBuffer cut(gpu::Recorder& gpu, const FrameInputs& frame, const GBuffer& wide, const GBuffer& prepared);

}  // namespace alcove
