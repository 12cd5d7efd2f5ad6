// The passes for surfaces behind the first: from files, and from other frames and views.
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

/// Gives the prepared G-buffer its hidden surfaces from the frame's planes; the same one if the frame has none, or none
/// is to be kept.
GBuffer layers(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering);

/// Finds the ends of surfaces along rows and columns: see ends.comp.
gpu::Buffer& ends(gpu::Recorder& gpu, const GBuffer& layered);

/// Of the surfaces of unknown kind (bits of `open`), finds the ones that close a solid, and marks them as in
/// GBuffer::hidden.
void pair(gpu::Recorder& gpu, const GBuffer& layered, const gpu::Buffer& open, const gpu::Buffer& ends);

/// Splits the hidden surfaces into planes for files: see FrameOutputs::hidden.
gpu::Buffer& hidden_planes(gpu::Recorder& gpu, const GBuffer& gbuffer, const Layering& layering);

/// Writes OtherView::moving into `moving`, also for all pixels that cannot stand for their surface. `witnesses` are
/// other frames, whose `to_here` leads to the view space of `view`. Without any nothing moves.
void surfels(gpu::Recorder& gpu, const OtherView& view, std::span<const OtherView> witnesses,
             const gpu::Buffer& moving);

/// Adds to `flags`, one uint per pixel of the view, the findings of a witness.
void still(gpu::Recorder& gpu, const OtherView& view, const OtherView& witness, const gpu::Buffer& flags);

/// Adds the hidden surfaces of other views to the G-buffer: planes of keys (key_of() of view.glsl), nearer first, each
/// behind the one before by more than the separation. The order of the views changes no bit. The nearest of these
/// surfaces fill the margin. Returns the same G-buffer without other views, or if no surface is to be kept and there is
/// no margin.
GBuffer warp(gpu::Recorder& gpu, const GBuffer& prepared, const FrameInputs& frame, const Layering& layering);

}  // namespace alcove
