// Parameters and bindings of composite.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_COMPOSITE_H
#define ALCOVE_COMPOSITE_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kCompositeAo = 0;  // in: one float per pixel, visibility; with has_color planes R, G, B
// in: planes R, G, B and, with alpha, A; premultiplied scene-linear colour
ALCOVE_CONSTANT uint kCompositeBeauty = 1;
// in: planes R, G, B of every ambient light; not read without
ALCOVE_CONSTANT uint kCompositeLight = 2;
// in: planes R, G, B of the colours that multiply some of them; not read without
ALCOVE_CONSTANT uint kCompositeColor = 3;
ALCOVE_CONSTANT uint kCompositeResult = 4;  // out: the beauty's planes, alpha too
ALCOVE_CONSTANT uint kCompositeCounts = 5;  // in and out: FrameCounts
// in: one float per pixel, planar depth, kSkyDepth for sky; not read without fog
ALCOVE_CONSTANT uint kCompositeDepth = 6;
ALCOVE_CONSTANT uint kCompositeLights = 7;  // in: an AmbientLight for each; not read without

/// A part of the beauty that AO may dim.
struct AmbientLight {
  float weight;  // how much of its light it dims
  int color;     // which of the colours multiplies the light (Blender: DiffInd x DiffCol); below 0: the light holds it
};

struct CompositeParams {
  View view;
  uint has_alpha;     // 0: every pixel is wholly covered
  uint lights;        // ambient ones, which alone are dimmed; 0: the whole beauty is
  uint has_color;     // 1: the visibility has a plane per colour
  float fog_density;  // of the beauty's fog, 1 / scene units, >= 0; 0: none
  float gain;         // factor on the occlusion, >= 0
  float mix;          // of the composite and the beauty, 0 to 1
  vec3 tint;          // what occlusion makes of white light, 0 to 1
};
ALCOVE_PARAMS(CompositeParams)

ALCOVE_END
#endif
