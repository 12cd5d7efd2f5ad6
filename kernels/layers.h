// Parameters and bindings of layers.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_LAYERS_H
#define ALCOVE_LAYERS_H
#include "shared.h"
ALCOVE_BEGIN

// in: planes of floats: planar depth > 0 of surfaces in any order, below 0 of those that close the solid before them;
// kSkyDepth where there is none
ALCOVE_CONSTANT uint kLayersFound = 0;
ALCOVE_CONSTANT uint kLayersDepth = 1;   // in: one float per pixel, planar depth of the first surface, from prepare
ALCOVE_CONSTANT uint kLayersHidden = 2;  // out: planes of floats, see GBuffer::hidden
ALCOVE_CONSTANT uint kLayersCounts = 3;  // in and out: LayerCounts, zeroed before
ALCOVE_CONSTANT uint kLayersWarped = 4;  // in: planes of keys of surfaces that other views show, see keys.glsl
// out: one uint per pixel: bit k is set if the surface k of `hidden` is of unknown kind, and may close a solid
ALCOVE_CONSTANT uint kLayersOpen = 5;

ALCOVE_CONSTANT uint kLayersKeptId = 0;  // specialization: planes of `hidden`, 1 to kMostHidden

ALCOVE_CONSTANT uint kMostHidden = 3;

struct LayersParams {
  View view;
  uint planes;           // that were found
  uint open_planes;      // bit i: surfaces of plane i are of unknown kind
  uint warped;           // planes from other views
  vec3 depth_precision;  // scene units: a depth z may be off by x + y z + z z^2
  float separation;      // scene units: surfaces closer than it are one; below 0: by precision and a pixel's slope
};
ALCOVE_PARAMS(LayersParams)

/// What is counted over a frame.
struct LayerCounts {
  uint surfaces;  // kept behind the first
  uint dropped;   // behind those that are kept
  uint before;    // that lie before the first surface, by more than the separation: nothing can be hidden there
};

ALCOVE_END
#endif
