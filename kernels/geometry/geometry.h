// Parameters of the kernels that the sources of core/chain/geometry run.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_GEOMETRY_H
#define ALCOVE_GEOMETRY_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

// How raw depth becomes planar depth.
ALCOVE_CONSTANT uint kDepthLinear = 0;  // z = base + slope * (raw - origin)
// z = 1 / (base + slope * (raw - origin)): 1/z, and the z-buffer of any perspective projection
ALCOVE_CONSTANT uint kDepthReciprocal = 1;
ALCOVE_CONSTANT uint kDepthExponential = 2;  // z = base * (exp(slope * (raw - origin)) - 1)
ALCOVE_CONSTANT uint kDepthPosition = 3;     // z = base + dot(axis, position); (0, 0, 0) is sky

struct DepthTerms {
  vec3 axis;                  // scene units per unit of the file, of kDepthPosition
  uint along_ray;             // 0 or 1: what the form gives is the distance to the eye
  float origin, base, slope;  // see the forms; z in scene units
  float sky_below;            // raw depth at or below it is sky
  float sky_above;            // raw depth at or above it is sky
  float sky_depth;            // a distance at or beyond it is sky, scene units
};

ALCOVE_CONSTANT uint kNormalNone = 0;        // all are reconstructed from depth
ALCOVE_CONSTANT uint kNormalVector = 1;      // x, y, z of any length
ALCOVE_CONSTANT uint kNormalXy = 2;          // x, y of a unit vector with z >= 0
ALCOVE_CONSTANT uint kNormalOctahedral = 3;  // two coordinates in [-1, 1]
ALCOVE_CONSTANT uint kNormalSpheremap = 4;   // two coordinates in [-1, 1]

// Pixels of a column that one invocation of `prepare` makes. They share the atomics by which they are counted, each of
// which takes lavapipe as long as several pixels.
ALCOVE_CONSTANT uint kPrepareRun = 8;

struct PrepareParams {
  View view;
  vec3 view_from_normal_x;  // rows of the rotation from the normals' space to view space
  vec3 view_from_normal_y;
  vec3 view_from_normal_z;
  DepthTerms depth;
  uint normal_unorm;  // 0 or 1: the file holds 0.5 + 0.5 n
};

struct ReconstructParams {
  View view;
};

struct DownsampleParams {
  View view;       // of the pixels
  ivec2 low_size;  // blocks
  ivec2 overhang;  // px: how far the first block reaches beyond the left and upper border
  uint hidden;     // planes of hidden surfaces
};

ALCOVE_CONSTANT uint kWidenEmpty = 0;   // the margin is left open: all that other views see is behind it
ALCOVE_CONSTANT uint kWidenFilled = 1;  // the margin alone is written, with what was found

struct WidenParams {
  View view;
  View wide;
  ivec2 margin;  // px that `wide` has to the left of `view` and above it
};

struct CutParams {
  ivec2 size;    // px, of the frame
  ivec2 wide;    // px, of the frame with its margin
  ivec2 margin;  // px to the left of the frame and above it
  uint planes;
};

ALCOVE_CONSTANT uint kMatteCoverage = 0;  // one plane of it
ALCOVE_CONSTANT uint kMatteNumbers = 1;   // one plane of objects
ALCOVE_CONSTANT uint kMatteRanked = 2;    // pairs of planes: an object, and its coverage

struct MatteParams {
  ivec2 size;    // px
  uint objects;  // that are meant
};

struct NeededParams {
  ivec2 size;        // px of the image: its blocks
  ivec2 frame_size;  // px
  ivec2 offset;      // px from the frame's corner to that of the image's first block
  int reach;         // px of the image about a receiver whose estimates it needs
};

// px: pixels that objects share look so far for one that tells them apart
ALCOVE_CONSTANT int kOccludersReach = 2;

struct OccludersParams {
  View view;
  uint ignores;    // 1: what the matte takes is no occluder; 0: what it does not take
  uint keeps;      // 1: where nothing is known behind such a surface, it stays
  uint lists_all;  // 1: a pixel with fewer hidden surfaces has no more: see GBuffer::hides_no_more
};

ALCOVE_END
#endif
