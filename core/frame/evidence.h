// Evidence in the pixels of a frame, and the choices made by it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/settings.h"

namespace alcove {

/// The coarseness of stored values, of any sample type.
struct Grain {
  double median = 0;  // of the values' distances from 0; where there is a step, each of them counts once
  double step = 0;    // from one value to the next at the median; 0: as fine as floats are, or too few values to tell
  bool is_coarse = false;  // the step is more than a 2^14th of the median
  bool is_fixed = false;   // the step is the same for small and large values
  bool is_half = false;    // the steps are a half float's, or a scaled half float's
};
/// A way to read depth and how well the frame's flat surfaces agree with it.
struct DepthScore {
  DepthKind kind;
  // The share of the smooth blocks that are flat by this kind and by no other.
  double straight = 0;
};
/// The curve from places in the picture to depth values, as measured on planes at an angle. If L is affine over a
/// plane's picture and v = f(L) is the value, then v'' / v'^2 is a function of v alone, the same for all planes: 2 / (v
/// + c) for planar depth that counts from a plane at distance c.
struct Curve {
  std::size_t planes = 0;  // blocks of the picture that show one
  // v'^2 / v'' = slope v + offset: 1/2 and 0 of distances, 0 of logarithms, p / (1 + p) of distances to the power of p
  double slope = 0.5, offset = 0;
  double median = 0;     // value
  double spread = 0;     // of the planes' own numbers about that line, relative to the median value
  bool is_wide = false;  // the values are different enough to tell the slope
};
/// A choice that neither settings nor camera make.
struct Guess {
  std::string what, chosen, why, option;  // the option makes the choice
};

/// Facts that the pixels of a frame show.
struct Evidence {
  bool tells = true;                     // false: the pixels left a question open
  Grain grain;                           // of the depth's values
  std::vector<DepthScore> depth_scores;  // of depth that is no position
  Curve curve;                           // of the same
  // of the surfaces, scene units; none until the frame is settled, and where all is sky
  std::optional<double> median_depth;
  std::optional<NormalSpace> space_by_shift;  // of normals that give the shift of a coarse disparity
  std::vector<Guess> guesses;
};

}  // namespace alcove
