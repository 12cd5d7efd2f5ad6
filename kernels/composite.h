// Parameters and bindings of composite.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COMPOSITE_H
#define ALCOVE_COMPOSITE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCompositeAo = 0;  // in: one float per pixel, visibility; with has_color planes R, G, B
// in: planes R, G, B and, with alpha, A; premultiplied scene-linear colour
ALCOVE_CONSTANT uint kCompositeBeauty = 1;
// in: planes R, G, B of the indirect diffuse light; not read without ambient parts
ALCOVE_CONSTANT uint kCompositeIndirect = 2;
// in: planes R, G, B of the diffuse colour that multiplies it; not read without
ALCOVE_CONSTANT uint kCompositeDiffuseColor = 3;
ALCOVE_CONSTANT uint kCompositeResult = 4;  // out: the beauty's planes, alpha too
ALCOVE_CONSTANT uint kCompositeCounts = 5;  // in and out: FrameCounts
// in: one float per pixel, planar depth, kSkyDepth for sky; not read without fog
ALCOVE_CONSTANT uint kCompositeDepth = 6;

struct CompositeParams {
  View view;
  uint has_alpha;          // 0: every pixel is wholly covered
  uint has_ambient;        // 1: only the ambient part is dimmed; 0: the whole beauty is
  uint has_diffuse_color;  // 1: ambient = indirect x diffuse colour (Blender); 0: indirect already holds it
  uint has_color;          // 1: the visibility has a plane per colour
  float fog_density;       // of the beauty's fog, 1 / scene units, >= 0; 0: none
};
ALCOVE_PARAMS(CompositeParams)

ALCOVE_END
#endif
