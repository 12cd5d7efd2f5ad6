// Parameters and bindings of multi_bounce.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_MULTI_BOUNCE_H
#define ALCOVE_MULTI_BOUNCE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kMultiBounceAo = 0;      // in: one float per pixel, visibility in [0, 1]
ALCOVE_CONSTANT uint kMultiBounceAlbedo = 1;  // in: planes r, g, b of the diffuse colour, linear; not read without
ALCOVE_CONSTANT uint kMultiBounceResult = 2;  // out: planes r, g, b, visibility in [0, 1]

struct MultiBounceParams {
  ivec2 size;       // px
  uint has_planes;  // 1: one colour per pixel; 0: `albedo` everywhere
  float albedo;     // 0 to 1
};
ALCOVE_PARAMS(MultiBounceParams)

ALCOVE_END
#endif
