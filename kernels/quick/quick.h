// Parameters of the kernels of the quick search.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_QUICK_H
#define ALCOVE_QUICK_H
#include "kernels/base/blocks.h"
#include "kernels/base/shared.h"
ALCOVE_BEGIN

// px of depth around the picture. Frames of 960 x 540 err by .0883 without, .0842 with 64, .0838 with 96, .0835 with
// 160.
ALCOVE_CONSTANT int kDepthMargin = 96;

struct MarginParams {
  View view;
};

struct QuickParams {
  View view;
  SiteGrid grid;
  float radius;          // scene units
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

ALCOVE_END
#endif
