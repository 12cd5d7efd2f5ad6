// Parameters and bindings of specular_occlusion.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_SPECULAR_OCCLUSION_H
#define ALCOVE_SPECULAR_OCCLUSION_H
#include "shared.h"
ALCOVE_BEGIN

ALCOVE_CONSTANT uint kSpecularOcclusionDepth = 0;  // in: one float per pixel, planar depth, kSkyDepth for sky
// in: one uint per pixel, unit vector in view space, see normal.glsl
ALCOVE_CONSTANT uint kSpecularOcclusionNormal = 1;
ALCOVE_CONSTANT uint kSpecularOcclusionBent = 2;    // in: one uint per pixel, as the normal: the mean open direction
ALCOVE_CONSTANT uint kSpecularOcclusionAo = 3;      // in: one float per pixel, visibility in [0, 1]
ALCOVE_CONSTANT uint kSpecularOcclusionResult = 4;  // out: one float per pixel in [0, 1]

struct SpecularOcclusionParams {
  View view;
  float roughness;  // of the surface, perceptual (its square is the width of a GGX lobe), 0 to 1
};
ALCOVE_PARAMS(SpecularOcclusionParams)

ALCOVE_END
#endif
