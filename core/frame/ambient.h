// The parts of a beauty that AO may dim: finds the planes of --set ambient, or those that are usual.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/frame/gbuffer.h"

namespace alcove {

/// Finds the lights in the beauty's file. `settings.ambient` lists them with commas, each LIGHT[*LAYER][*NUMBER]: a
/// layer, one that multiplies it, and how much of it AO dims, 0 to 1. Without, it is the indirect diffuse light, where
/// that is found; else there is none.
///
/// Blender's light passes are without the surface's colour. It is taken from the pass beside them (DiffInd x DiffCol,
/// GlossDir x GlossCol) where nothing else is said. Fails with ErrorKind::usage on a text that is no such list, and
/// with ErrorKind::input where a layer is missing.
void find_ambient(FrameSource& source, const ChannelSearch& search, std::size_t file, const InputSettings& settings);

}  // namespace alcove
