// Mattes: the pixels that want AO, and the surfaces that may block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/geometry/geometry.h"

namespace alcove {

/// The part of each pixel that wants AO.
struct Matte {
  gpu::Buffer* plane = nullptr;  // coverage, 0 to 1, over the frame; null: all want it
  double outside = 1;            // the AO where it is 0
};

/// A matte, or that of RawPlane::occluders, as one plane of coverage over the frame; none if the frame has none.
Matte matte(gpu::Recorder& gpu, const FrameInputs& frame, RawPlane which = RawPlane::matte);

/// The G-buffer with the tiles whose estimates are needed; the same one without a matte. Filters look up to `reach` px
/// of the frame beyond the matte. `wide`: the frame with its margin, see with_margin().
GBuffer needed(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& wide, const Matte& matte, int reach);

/// The stand-in for the unknown surfaces behind one that does not block.
enum class Unknown {
  open,     // nothing
  blocked,  // the surface in front of them, which blocks the most
};

/// The G-buffer with its occluders, if the frame has surfaces that do not block; else the same one. Receivers stay as
/// they are.
GBuffer occluders(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                  Unknown unknown = Unknown::open);

}  // namespace alcove
