// The passes that bring in what lies behind the first surface: from the files, and from other frames and views.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/chain/geometry/geometry.h"

namespace alcove {

/// The number of surfaces that are kept behind the first, and the distance within which two are one.
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

/// Puts into `moving` what OtherView says of it, and with it all pixels that cannot stand for their surface.
/// `witnesses` are other frames; `to_here` of each leads from its view space to that of `view`. Without any nothing
/// moves.
void surfels(gpu::Recorder& gpu, const OtherView& view, std::span<const OtherView> witnesses,
             const gpu::Buffer& moving);

/// Adds to `flags`, one uint per pixel of the view, what a witness sees of it.
void still(gpu::Recorder& gpu, const OtherView& view, const OtherView& witness, const gpu::Buffer& flags);

/// Gives the G-buffer the surfaces that others show behind the first: planes of keys, see keys.glsl, nearer first,
/// each behind the one before by more than the separation. The order of the others changes no bit. A frame with a
/// margin gets it, filled with the nearest of those surfaces. The same G-buffer where the frame has no others, or none
/// is to be kept and there is no margin.
GBuffer warp(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering);

}  // namespace alcove
