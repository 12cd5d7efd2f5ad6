// Parameters of the kernels of the quick search, which works in blocks of 4 x 4 pixels.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_QUICK_H
#define ALCOVE_QUICK_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT int kBlock = 4;  // px a side
// Sites of a block, at most; its word holds 7. With 4, leaves err by .003 more than with 7, and hair by .008.
ALCOVE_CONSTANT int kBlockSites = 6;

// px of depth around the picture. Frames of 960 x 540 err by .0883 without, .0842 with 64, .0838 with 96, .0835 with
// 160.
ALCOVE_CONSTANT int kDepthMargin = 96;

// A pixel takes the sites of the blocks beside its own, and each of these those of the two blocks beyond: 1 + 3 * 4 px.
ALCOVE_CONSTANT int kQuickReach = 13;

struct BlocksParams {
  View view;
  ivec2 overhang;        // px of the first block to the left of the image and above it
  ivec2 blocks;          // in x and y
  float reach;           // px at unit depth (orthographic: at any): how far fit_blocks takes sites at most
  float radius;          // scene units
  float bias;            // sine of the elevation above the tangent plane below which nothing blocks
  ivec2 noise_origin;    // px: added to a pixel, so that crops and tiles share one noise pattern
  vec2 noise_shift;      // in [0, 1): the pattern's shift for this frame and seed
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

ALCOVE_END
#endif
