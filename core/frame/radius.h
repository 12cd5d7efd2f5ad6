// The radius that is proposed to those who do not name one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "core/frame/reading.h"

namespace alcove {

/// Gives the median planar depth of the surfaces, in scene units; none where all is sky. `raw` is the depth as the file
/// has it, or the positions, of the pixels of `reading.data`; a few ten thousand of them are looked at.
std::optional<double> median_depth(const Reading& reading, std::span<const float> raw);

/// Gives a radius in scene units by one figure, which is as much as a guess deserves. None where the frame shows no
/// surface, and so has no median depth. It is the same for every frame of a sequence if it is asked of the one by which
/// the sequence is settled.
std::optional<double> proposed_radius(const Camera& camera, std::optional<double> median_depth);

}  // namespace alcove
