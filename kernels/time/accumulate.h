// Parameters of the kernels that core/chain/time/accumulate.cpp runs, and the frames that these take the mean of.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_ACCUMULATE_H
#define ALCOVE_ACCUMULATE_H
#include "kernels/base/shared.h"
ALCOVE_BEGIN

struct SuspectsParams {
  View view;      // of the frame that takes the mean
  ivec2 squares;  // of the largest of all frames
};

/// A frame, and where its planes of words begin. The first one holds planar depths as floats, kSkyDepth for sky, and
/// below 0, of the same size, where motion vectors tell that the surface moves. The second one holds normals in its
/// lower half, 8 bits for each coordinate of normal.glsl and kNoTakenNormal for none, and in its upper half the first
/// of the values, which lie in [0, 1]. The others hold two values each.
struct NeighbourFrame {
  View view;
  vec3 row_x, row_y, row_z;  // view space of the frame that takes its estimate -> its own: rows of the linear part
  vec3 offset;               // and what is added, scene units
  vec3 depth_precision;      // scene units: depths z of both may be off by x + y z + z z^2 together
  uint first;                // word of the buffer
};

ALCOVE_CONSTANT uint kNoTakenNormal = 0x8080;
ALCOVE_CONSTANT uint kMostNeighbours = 9;  // frames of a buffer

ALCOVE_CONSTANT int kSquares = kTile / 2;  // of 2 x 2 pixels, a side of a tile: one pixel of each is looked at

ALCOVE_CONSTANT uint kMovedCells = 1 << 20;  // so many that few cells share a word
ALCOVE_NUMBER kMovedCell = 1.0 / 3.0;        // radii: the side of a cell, in the view space of the frame

struct MovedParams {
  View view;      // of the frame that takes the mean
  float radius;   // scene units: what moves within it may change an estimate
  uint place;     // of the first frame of the buffer among all others
  ivec2 squares;  // as of SuspectsParams
  int rows;       // of workgroups for each frame
};

ALCOVE_CONSTANT uint kAccumulateBegins = 1;  // the sums begin, with the frame's own estimate
ALCOVE_CONSTANT uint kAccumulateEnds = 2;    // the mean is made of them

struct AccumulateParams {
  View view;     // of all of the frame that takes the mean
  ivec2 size;    // px, of the part that is computed
  ivec2 corner;  // px from the frame's corner to that of the part
  float radius;  // scene units: what moves within it may change an estimate
  uint place;    // of the first frame of the buffer among all others
  int scales;    // of the values, those of radii
  uint frames;   // of these that count: the first ones
  uint stage;    // bits of kAccumulateBegins and kAccumulateEnds
};

ALCOVE_END
#endif
