// Parameters of the kernels that core/chain/results/shading.cpp runs.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SHADING_H
#define ALCOVE_SHADING_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct BentNormalParams {
  ivec2 size;  // px
};

ALCOVE_CONSTANT uint kShapeByIntensity = 1;  // what is not asked for leaves every bit as it is
ALCOVE_CONSTANT uint kShapeByPower = 2;
ALCOVE_CONSTANT uint kShapeByFade = 4;
ALCOVE_CONSTANT uint kShapeByMaterial = 8;
ALCOVE_CONSTANT uint kShapeByMatte = 16;
ALCOVE_CONSTANT uint kShapeCountsRepaired = 32;  // else the frame's material AO has been counted

struct ShapeParams {
  ivec2 size;        // px
  float intensity;   // factor on the occlusion, >= 0
  float power;       // exponent of the visibility, > 0
  float fade_start;  // scene units of planar depth: where the AO begins to fade
  float fade_end;    // scene units, > fade_start: where it is 1
  float outside;     // visibility where the matte is 0
  uint planes;       // how many
};

struct DirectionsParams {
  ivec2 size;        // px
  vec3 x_from_view;  // rows of the rotation from view space
  vec3 y_from_view;
  vec3 z_from_view;
};

struct SpecularOcclusionParams {
  View view;
  float roughness;  // of the surface, perceptual (its square is the width of a GGX lobe), 0 to 1
};

struct MultiBounceParams {
  ivec2 size;       // px
  uint has_planes;  // 1: one colour per pixel; 0: `albedo` everywhere
  float albedo;     // 0 to 1
};

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

ALCOVE_END
#endif
