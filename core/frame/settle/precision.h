// The precision of depth values, from files or from memory: how they were rounded, sampled and filtered.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "core/base/image.h"
#include "core/base/note.h"
#include "core/frame/evidence.h"
#include "core/frame/reading.h"

namespace alcove {

/// Measures how the depth of a window was rounded, and takes it down in `reading`: it changes how the values are
/// judged, and how near occluders may be. Positions are not measured. Fails with ErrorKind::input, calling the depth
/// `name`, if it holds 256 values at most, as a grey picture does.
Grain measure_rounding(Reading& reading, const Window& window, std::span<const float> depth, const std::string& name);

/// Takes down the step of depth between planes that was stored as integers. The kind of the depth must be settled.
void measure_levels(Reading& reading, std::span<const float> depth);

/// Notes depth, called `name`, that AO takes for relief or for sky: depth that was rounded, that ends where half floats
/// end, that was sampled at random places of the pixels, or that was averaged over them, and bars around a picture.
/// `reading` is settled; of large frames a part of the pixels is looked at.
Notes precision_notes(const Reading& reading, const Window& window, std::span<const float> depth, const Grain& grain,
                      const std::string& name);

/// Gives the share of the rows' steps from one surface to another that take a pixel in between: near 0 for point
/// samples, near 1 for averaged pixels, and 0 if there are too few steps to tell. `planar` is infinite on sky.
double blended_edges(std::span<const float> planar, int width);

}  // namespace alcove
