// Whether the light passes of a frame add up to its beauty, as a composite of them needs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/frame/find/frame_source.h"

namespace alcove {

struct InspectedLight {
  std::string renderer;              // whose passes they are by their names
  std::string sum;                   // such as "(DiffDir + DiffInd) x DiffCol + Emit"
  std::vector<std::string> lacking;  // passes of that renderer that the file does not hold
  double share = 0;                  // of the beauty that the sum is, over the surfaces
  double other_part = 0;             // of the surfaces, where the sum is another light than the beauty
  double other_share = 1;            // of the beauty there that the sum is
  bool adds_up = false;              // the sum is the beauty all over the surfaces, up to noise
};

/// Adds up the light passes beside the beauty at some rows. `planar` is the depth over the beauty's pixels, infinite
/// where there is no surface: a background is light of no surface. None if no renderer is known by the names of the
/// passes, or if they cover other pixels than the depth.
std::optional<InspectedLight> light_passes_of(FrameSource& source, std::span<const float> planar);

/// The sentence on passes that do not add up.
std::string missing_light_text(const InspectedLight& light);

}  // namespace alcove
