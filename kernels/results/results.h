// Parameters of the kernels that the sources of core/chain/results run.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_RESULTS_H
#define ALCOVE_RESULTS_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct BentNormalParams {
  ivec2 size;  // px
};

ALCOVE_CONSTANT uint kCurvatureConvexity = 1;  // what is wanted
ALCOVE_CONSTANT uint kCurvatureCavity = 2;
ALCOVE_CONSTANT uint kCurvatureBoth = 4;
ALCOVE_CONSTANT uint kCurvatureByMatte = 8;

struct CurvatureParams {
  ivec2 size;  // px
  uint first;  // plane of what is open inside at the smallest radius
};

ALCOVE_CONSTANT uint kShapeByIntensity = 1;  // what is not asked for leaves every bit as it is
ALCOVE_CONSTANT uint kShapeByPower = 2;
ALCOVE_CONSTANT uint kShapeByFade = 4;
ALCOVE_CONSTANT uint kShapeByMaterial = 8;
ALCOVE_CONSTANT uint kShapeByLeast = 16;
ALCOVE_CONSTANT uint kShapeByMatte = 32;
ALCOVE_CONSTANT uint kShapeCountsRepaired = 64;  // else the frame's material AO has been counted

struct ShapeParams {
  ivec2 size;        // px
  float intensity;   // factor on the occlusion, >= 0
  float power;       // exponent of the visibility, > 0
  float fade_start;  // scene units of planar depth: where the AO begins to fade
  float fade_end;    // scene units, > fade_start: where it is 1
  float least;       // the lowest visibility but of the matte, 0 to 1
  float outside;     // visibility where the matte is 0
  uint planes;       // how many
};

struct DirectionsParams {
  ivec2 size;        // px
  vec3 x_from_view;  // rows of the rotation from view space
  vec3 y_from_view;
  vec3 z_from_view;
};

struct TransferParams {
  ivec2 size;        // px
  uint plane;        // of the AO: of the largest radius
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

/// A part of the beauty that AO may dim, or a shadow.
struct AmbientLight {
  float weight;  // how much of its light AO dims
  int color;     // which of the colours multiplies the light (Blender: DiffInd x DiffCol); below 0: the light holds it
  int shadow;    // plane of the shadow that dims it; below 0: none
};

struct CompositeParams {
  View view;
  uint has_alpha;     // 0: every pixel is wholly covered
  uint lights;        // that are dimmed
  uint dims_beauty;   // 1: AO dims the whole beauty, 0: the lights by their weights
  uint has_color;     // 1: the visibility has a plane per colour
  float fog_density;  // of the beauty's fog, 1 / scene units, >= 0; 0: none
  float gain;         // factor on the occlusion, >= 0
  float least;        // visibility that the gain takes nothing below, 0 to 1
  float mix;          // of the composite and the beauty, 0 to 1
  vec3 tint;          // what occlusion makes of white light, 0 to 1
};

struct ConfidenceParams {
  View view;
  float radius;          // scene units
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
};

struct ReduceParams {
  ivec2 size;    // px
  ivec2 offset;  // px of the upper left block that lie left of the planes and above them
  int factor;    // px of a block in x and in y
  int first;     // px from a block's corner to the first pixel that counts for it, at most 0
  int count;     // weights, of which those of the block's own pixels are not all 0
  uint planes;
};

ALCOVE_CONSTANT uint kDebugValue = 0;        // the values as they are
ALCOVE_CONSTANT uint kDebugPlanarDepth = 1;  // scene units
ALCOVE_CONSTANT uint kDebugViewZ = 2;        // z in view space, scene units, below 0
ALCOVE_CONSTANT uint kDebugNormalZ = 3;      // z of the normal in view space
ALCOVE_CONSTANT uint kDebugNormalAngle = 4;  // degrees between the two sets of normals
ALCOVE_CONSTANT uint kDebugEdge = 5;         // distance of a neighbour from the tangent plane, part of the depth
ALCOVE_CONSTANT uint kDebugDensity = 7;      // share of the pixels of a square of 4 x 4 that are sites
ALCOVE_CONSTANT uint kDebugTile = 6;         // share of the directions that are searched, of the pixel's tile

ALCOVE_CONSTANT uint kDebugHidden = 8;  // surfaces behind the first, and half a one where any closes a solid

struct DebugParams {
  View view;
  SiteGrid grid;  // of sites; only if sparse
  uint kind;      // one of kDebug*
  uint sparse;    // of kDebugValue and kDebugDensity: 1: only sites have a value
  ivec2 origin;   // px from the display window's corner to the image's
  uint hidden;    // of kDebugHidden: planes of surfaces behind the first
};

ALCOVE_END
#endif
