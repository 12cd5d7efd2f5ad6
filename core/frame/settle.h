// Decides by the pixels what settings and camera leave open about a frame: kind and sign of depth, space and encoding
// of normals.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"

namespace alcove {

/// Settles what is open in `source`, from the planes of depth and normals as they were read, and adds to its guesses
/// and notes. What the settings or the camera file say is never overruled. Fails with ErrorKind::input where the pixels
/// speak for two ways or against all, naming the options that decide; under settings.strict, wherever there is a guess.
/// Near or far that are missing are ErrorKind::usage.
void settle(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
            std::span<const float> normal);

/// Settles a frame as another one of its sequence is settled. False: it has other planes, so it must be settled by
/// itself.
bool settle_like(FrameSource& source, const FrameSource& settled);

/// Whether depth of this kind may be stored as integers: see step_of().
bool has_step(DepthKind kind);

}  // namespace alcove
