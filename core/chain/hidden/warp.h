// The passes that bring in what other frames and other views see.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/chain/hidden/hidden.h"

namespace alcove {

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
