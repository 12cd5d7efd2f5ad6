// The passes that bring in what lies behind the first surface.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/geometry/geometry.h"

namespace alcove {

/// How many surfaces are kept behind the first, and when two are one.
struct Layering {
  int kept;           // 0 to kMostHidden
  double separation;  // scene units; below 0: by the depth's precision and a pixel's slope
};
Layering layering_of(const EstimatorSettings& settings);

/// Planar depth of all surfaces that the frame's files hold behind the first, a plane behind the other in the order of
/// the files.
gpu::Buffer& behind(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame);

/// Gives the prepared G-buffer its hidden surfaces, from what the frame has read of them; the same one where the frame
/// has none, or none is to be kept.
GBuffer layers(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering);

/// Says where surfaces end along rows and columns: see ends.comp.
gpu::Buffer& ends(gpu::Recorder& gpu, const GBuffer& layered);

/// Finds which of the surfaces of unknown kind, the bits of `open`, close a solid, and marks them as GBuffer::hidden
/// says.
void pair(gpu::Recorder& gpu, const GBuffer& layered, const gpu::Buffer& open, const gpu::Buffer& ends);

/// Splits what is hidden into planes for other programs: see FrameOutputs::hidden.
gpu::Buffer& hidden_planes(gpu::Recorder& gpu, const GBuffer& gbuffer, const Layering& layering);

}  // namespace alcove
