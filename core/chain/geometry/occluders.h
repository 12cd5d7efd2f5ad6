// What may block: all surfaces but those that a matte leaves out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/geometry/geometry.h"

namespace alcove {

/// What stands for the surfaces that nobody knows behind one that is no occluder.
enum class Unknown {
  open,     // nothing
  blocked,  // the surface in front of them: nothing that they may be blocks more
};

/// The G-buffer with its occluders, where the frame says that some surfaces are none; else the same one. Receivers, and
/// all that is decided by what is seen, stay as they are.
GBuffer occluders(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                  Unknown unknown = Unknown::open);

}  // namespace alcove
