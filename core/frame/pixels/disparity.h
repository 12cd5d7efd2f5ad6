// The shift of disparity by which a frame's depth agrees with its normals. Knows no network.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/frame/evidence.h"
#include "core/frame/pixels/normal_scores.h"

namespace alcove {

/// The shift b of disparity d = a / z + b by one reading of the normals.
struct ShiftScore {
  NormalSpace space;
  NormalFlips flips;
  double shift = 0;
  double error = 0;      // it lies within so much of that
  double agreement = 0;  // the part of the disparity's slopes that it explains, at most 1; 0 and less: none
};

/// Gives the shift by each reading of the normals, the best agreement first; nothing where too few places show one.
/// Opposite normals are one reading. `grain` is that of the disparity.
///
/// On a plane 1/z is in proportion to s = normal * ray, so two of its pixels p and q give b: (d_q - b) s_p = (d_p - b)
/// s_q. The scale a drops out. All pairs together give b by their weighted median.
std::vector<ShiftScore> score_shifts(const NormalPlanes& planes, const Grain& grain);

}  // namespace alcove
