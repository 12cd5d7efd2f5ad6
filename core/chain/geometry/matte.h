// Where AO is wanted: the matte as a plane, and the tiles that its receivers need.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/geometry/geometry.h"

namespace alcove {

/// A matte, or that of RawPlane::occluders, as one plane of coverage over the frame; none where the frame has none.
Matte matte(gpu::Recorder& gpu, const FrameInputs& frame, RawPlane which = RawPlane::matte);

/// The G-buffer with the tiles whose estimates anybody needs, who looks up to `reach` px of the frame beyond the matte;
/// the same one where there is none. `wide` is the frame with its
/// margin: see with_margin().
GBuffer needed(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& wide, const Matte& matte, int reach);

}  // namespace alcove
